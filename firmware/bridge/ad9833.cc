#include "ad9833.h"

#include <algorithm>
#include <string>

#include "log.h"

// Every time that the data sheet asks for (its table 2: 3 to 25 ns) is shorter than one cycle, so
// an edge at least one cycle after the other keeps it, and two edges in one cycle may not.
void Ad9833::need(const char *what, uint64_t since, uint64_t &shortest) {
    const uint64_t cycles = now() - since;
    shortest = std::min(shortest, cycles);
    if (cycles == 0)
        log_event(std::string("\"error\": \"chip ") + name_ + ": no time for " + what + "\"");
}

bool Ad9833::fsync(bool level, bool clock_level) {
    if (!level) {
        selected_ = true;
        bits_ = 0;
        word_ = 0;
        fsync_fell_ = now();
        if (!clock_level)
            log_event(std::string("\"error\": \"chip ") + name_ + ": FSYNC fell with SCLK low\"");
        need("SCLK high to FSYNC", clock_rose_, times_.clock_to_fsync);
        return false;
    }
    if (!selected_) return false;
    selected_ = false;
    if (bits_ != 16) {
        log_event(std::string("\"error\": \"chip ") + name_ + ": " + std::to_string(bits_) +
                  " bits in a word\"");
        return false;
    }
    need("FSYNC hold", clock_fell_, times_.fsync_hold);
    return true;
}

void Ad9833::clock(bool level, bool data_level) {
    if (level) {
        if (selected_ && bits_ > 0) need("SCLK low", clock_fell_, times_.clock_low);
        clock_rose_ = now();
        return;
    }
    if (selected_) {
        need("SDATA set-up", data_changed_, times_.data_set_up);
        need("FSYNC set-up", fsync_fell_, times_.fsync_set_up);
        if (bits_ > 0) need("SCLK high", clock_rose_, times_.clock_high);
        word_ = (word_ << 1 | data_level) & 0xFFFF;
        if (++bits_ == 16) latched_ = now();
    }
    clock_fell_ = now();
}

void Ad9833::data() {
    if (selected_ && bits_ > 0) need("SDATA hold", clock_fell_, times_.data_hold);
    data_changed_ = now();
}

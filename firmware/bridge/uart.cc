#include "uart.h"

#include <algorithm>
#include <string>

#include <gpsim_time.h>

void HostSender::send(uint8_t byte, uint64_t cycle) {
    queue_.push_back({byte, cycle});
    if (!busy_) start();
}

void HostSender::start() {
    busy_ = true;
    bit_ = 0;
    get_cycles().set_break(std::max(queue_.front().cycle, now() + 1), this);
}

void HostSender::callback() {
    if (bit_ == 10) {
        queue_.pop_front();
        bit_ = 0;
        busy_ = !queue_.empty();
        if (!busy_) return;
        if (queue_.front().cycle > now()) {
            start();
            return;
        }
    }
    const unsigned frame = queue_.front().byte << 1 | 0x200;
    wire_.drive(frame >> bit_ & 1);
    ++bit_;
    get_cycles().set_break(now() + bit_cycles, this);
}

HostReceiver::HostReceiver(Wire &wire) : wire_(wire) {
    wire_.watch([this](bool level) {
        if (level || busy_) return;
        busy_ = true;
        bit_ = 0;
        byte_ = 0;
        get_cycles().set_break(now() + bit_cycles / 2, this);
    });
}

void HostReceiver::callback() {
    // Bit 0 is the start bit, 1 to 8 are data, 9 is the stop bit: each is looked at in its middle.
    const bool level = wire_.level();
    if (bit_ >= 1 && bit_ <= 8) byte_ |= level << (bit_ - 1);
    if ((bit_ == 0 && level) || (bit_ == 9 && !level)) {
        log_event("\"error\": \"framing error on the line to the host\"");
        busy_ = false;
    } else if (bit_ == 9) {
        received.push_back(static_cast<uint8_t>(byte_));
        log_event("\"byte\": " + std::to_string(byte_));
        busy_ = false;
    } else {
        ++bit_;
        get_cycles().set_break(now() + bit_cycles, this);
    }
}

void HostReceiver::abandon() {
    if (busy_) get_cycles().clear_break(this);
    busy_ = false;
}

// The serial port of one AD9833: shifts words in, holds every edge against the data sheet's times.
#pragma once

#include <cstdint>

// Shortest times seen on the bus, in instruction cycles (135.6 ns); an edge in the same cycle is 0.
struct BusTimes {
    uint64_t data_set_up = UINT64_MAX;     // SDATA settled to SCLK falling
    uint64_t data_hold = UINT64_MAX;       // SCLK falling to SDATA changing
    uint64_t clock_high = UINT64_MAX;
    uint64_t clock_low = UINT64_MAX;
    uint64_t fsync_set_up = UINT64_MAX;    // FSYNC falling to SCLK falling
    uint64_t fsync_hold = UINT64_MAX;      // last SCLK falling to FSYNC rising
    uint64_t clock_to_fsync = UINT64_MAX;  // SCLK high to FSYNC falling
};

class Ad9833 {
public:
    explicit Ad9833(char name) : name_(name) {}

    // True where a whole word came in.
    bool fsync(bool level, bool clock_level);
    void abandon() { selected_ = false; }  // a word cut off by a reset, which the chip ignores
    void clock(bool level, bool data_level);
    void data();

    bool selected() const { return selected_; }
    unsigned word() const { return word_; }
    uint64_t latched() const { return latched_; }  // cycle of its last bit
    const BusTimes &times() const { return times_; }

private:
    void need(const char *what, uint64_t since, uint64_t &shortest);

    char name_;
    bool selected_ = false;
    unsigned bits_ = 0;
    unsigned word_ = 0;
    uint64_t clock_fell_ = 0, clock_rose_ = 0, fsync_fell_ = 0, data_changed_ = 0, latched_ = 0;
    BusTimes times_;
};

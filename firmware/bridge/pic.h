// The PIC18F2520 in gpsim, with what gpsim leaves out: true resets, and measurements of the code.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <interface.h>
#include <p18x.h>

enum class Cause { kPowerOn, kBrownOut, kWatchdog, kExternal, kSoftware, kStackFull, kStackUnderflow };

std::optional<Cause> cause_named(const std::string &name);

struct Measured {
    uint64_t interrupt_cycles = 0;  // longest from the vector to the end of `retfie`
    uint64_t masked_cycles = 0;     // longest that the main program kept interrupts off
    int stack_levels = 0;           // deepest return stack
};

class Pic : public P18F2520 {
public:
    // Loads a hex file whose records start at even addresses.
    explicit Pic(const std::string &image);

    void run_until(uint64_t cycle);
    void restart(Cause cause);
    bool resetting() const { return resetting_; }  // its pins are letting go
    std::function<void()> on_restart = [] {};
    // Put a reset off to the end of the instruction that causes it.
    void reset(RESET_TYPE type) override;

    IOPIN *port_pin(char port, unsigned bit);
    void write_register(unsigned address, unsigned value);  // as the program would
    void set_program_counter(unsigned address);
    const Measured &measured() const { return measured_; }

private:
    void set_register(unsigned address, unsigned value);  // its value alone, without effects
    void measure();

    std::optional<Cause> pending_;
    Measured measured_;
    std::optional<int> interrupt_level_;   // of the stack, within an interrupt
    std::optional<uint64_t> masked_since_;
    uint64_t interrupt_began_ = 0;
    bool interrupts_used_ = false, running_ = false, resetting_ = false;
};

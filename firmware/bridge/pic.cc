#include "pic.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <stdexcept>

#include <clock_phase.h>
#include <gpsim_time.h>
#include <hexutils.h>
#include <sim_context.h>

#include "log.h"

namespace {
constexpr unsigned kIntcon = 0xFF2, kStkptr = 0xFFC, kRcon = 0xFD0, kTrisB = 0xF93, kTrisC = 0xF94,
                   kSspcon1 = 0xFC6, kSspstat = 0xFC7, kRcsta = 0xFAB, kTxsta = 0xFAC;
constexpr unsigned kGie = 0x80, kStackFull = 0x80, kStackUnderflow = 0x40;
constexpr unsigned kInterruptVector = 0x0008;
constexpr double kClockHz = 4.0 * kCyclesPerSecond;
constexpr double kWatchdogSeconds = 4e-3;  // data sheet, parameter 31; gpsim takes 18 ms

struct CauseEntry {
    Cause cause;
    unsigned rcon;    // data sheet, table 4-3
    unsigned stkptr;
};

const std::map<std::string, CauseEntry> kCauses = {
    {"power_on", {Cause::kPowerOn, 0x1C, 0}},
    {"brown_out", {Cause::kBrownOut, 0x1E, 0}},
    {"watchdog", {Cause::kWatchdog, 0x17, 0}},
    {"external", {Cause::kExternal, 0x1F, 0}},
    {"software", {Cause::kSoftware, 0x0F, 0}},
    {"stack_full", {Cause::kStackFull, 0x1F, kStackFull}},
    {"stack_underflow", {Cause::kStackUnderflow, 0x1F, kStackUnderflow}},
};
}  // namespace

std::optional<Cause> cause_named(const std::string &name) {
    const auto found = kCauses.find(name);
    if (found == kCauses.end()) return std::nullopt;
    return found->second.cause;
}

Pic::Pic(const std::string &image) : P18F2520("pic") {
    create();
    create_invalid_registers();
    create_symbols();
    CSimulationContext::GetContext()->add_processor(this);
    set_frequency(kClockHz);
    setBreakOnReset(false);
    FILE *file = fopen(image.c_str(), "r");
    if (!file) throw std::runtime_error(image + ": cannot be read");
    const int failed = IntelHexProgramFileType().readihex16(this, file);
    fclose(file);
    if (failed) throw std::runtime_error(image + ": is not an Intel hex file");
    get_cycles().set_instruction_cps(static_cast<guint64>(kCyclesPerSecond));
    wdt.set_timeout(kWatchdogSeconds);
    restart(Cause::kPowerOn);
}

void Pic::reset(RESET_TYPE type) {
    if (!running_) {
        P18F2520::reset(type);
        return;
    }
    switch (type) {
        case WDT_RESET: pending_ = Cause::kWatchdog; break;
        case SOFT_RESET: pending_ = Cause::kSoftware; break;
        case STKOVF_RESET: pending_ = Cause::kStackFull; break;
        case STKUNF_RESET: pending_ = Cause::kStackUnderflow; break;
        default: pending_ = Cause::kExternal; break;
    }
}

// gpsim leaves most registers as they are at any reset but power-on, which would leave pins driven
// that the chip lets go; so every reset is a power-on there, and the cause is written after it.
void Pic::restart(Cause cause) {
    running_ = false;
    resetting_ = true;
    for (unsigned tris : {kTrisB, kTrisC}) registers[tris]->put(0xFF);  // before the latches change
    // gpsim stops these by writing to their registers, not by resetting them.
    for (unsigned control : {kSspcon1, kRcsta, kTxsta}) registers[control]->put(0);
    ssp.sspbuf.setFullFlag(false);
    get_cycles().clear_break(&usart.txsta);  // of the byte that was going out
    P18F2520::reset(POR_RESET);
    resetting_ = false;
    on_restart();
    intcon.in_interrupt = false;  // or a reset within an interrupt would leave it on for ever
    get_bp().clear_global();  // a halt that gpsim asked for would stop the cycle counter
    mExecute1Cycle->setNextPhase(mExecute1Cycle);
    mCurrentPhase = mExecute1Cycle;
    set_register(kSspstat, 0);
    for (const auto &[name, entry] : kCauses) {
        if (entry.cause != cause) continue;
        set_register(kRcon, entry.rcon);
        set_register(kStkptr, entry.stkptr);
        log_event("\"reset\": \"" + name + "\"");
    }
    interrupts_used_ = false;
    masked_since_.reset();
    interrupt_level_.reset();
    pending_.reset();
}

void Pic::run_until(uint64_t cycle) {
    running_ = true;
    while (now() < cycle) {
        step_cycle();
        measure();
        if (pending_ && mCurrentPhase == mExecute1Cycle) {
            restart(*pending_);
            running_ = true;
        }
    }
    running_ = false;
}

void Pic::measure() {
    const bool on = registers[kIntcon]->value.get() & kGie;
    if (on) {
        if (masked_since_) measured_.masked_cycles = std::max(measured_.masked_cycles, now() - *masked_since_);
        masked_since_.reset();
        interrupts_used_ = true;
    } else if (interrupts_used_ && !masked_since_) {
        masked_since_ = now();
    }
    const int level = stack->pointer;
    if (!interrupt_level_ && pc->value << 1 == kInterruptVector) {
        interrupt_level_ = level;
        interrupt_began_ = now();
    } else if (interrupt_level_ && level < *interrupt_level_) {  // `retfie` took its address
        interrupt_level_.reset();
        measured_.interrupt_cycles = std::max(measured_.interrupt_cycles, now() - interrupt_began_);
    }
    measured_.stack_levels = std::max(measured_.stack_levels, level);
}

IOPIN *Pic::port_pin(char port, unsigned bit) {
    PicPortRegister *ports[] = {m_porta, m_portb, m_portc};
    return ports[port - 'a']->getPin(bit);
}

void Pic::set_register(unsigned address, unsigned value) { registers[address]->value.put(value); }

void Pic::write_register(unsigned address, unsigned value) { registers[address]->put(value); }

void Pic::set_program_counter(unsigned address) { pc->put_value(address); }

// The host's end of the serial line, bit by bit.
#pragma once

#include <cstdint>
#include <deque>

#include <trigger.h>

#include "log.h"
#include "wire.h"

// Sends bytes to the board, one start bit, eight data bits, one stop bit each.
class HostSender : public TriggerObject {
public:
    explicit HostSender(Wire &wire) : wire_(wire) { wire_.drive(true); }
    // The byte starts at `cycle`, or when the ones before it are out.
    void send(uint8_t byte, uint64_t cycle);
    void callback() override;
    uint64_t bit_cycles = kCyclesPerBit;

private:
    struct Pending {
        uint8_t byte;
        uint64_t cycle;
    };
    void start();

    Wire &wire_;
    std::deque<Pending> queue_;
    unsigned bit_ = 0;  // of the byte at the head; 0 is the start bit
    bool busy_ = false;
};

// Takes the bytes the board sends and logs each in the middle of its stop bit.
class HostReceiver : public TriggerObject {
public:
    explicit HostReceiver(Wire &wire);
    void callback() override;
    void abandon();  // a byte cut off by a reset
    uint64_t bit_cycles = kCyclesPerBit;
    // Bytes since the bridge last emptied it.
    std::deque<uint8_t> received;

private:
    unsigned bit_ = 0;
    unsigned byte_ = 0;
    bool busy_ = false;
    Wire &wire_;
};

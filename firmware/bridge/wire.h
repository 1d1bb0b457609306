// A wire on the board: the pins on it, what pulls it, and who watches it.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>

#include <stimuli.h>

class Wire {
public:
    enum class Pull { kUp, kDown };

    Wire(const char *name, std::initializer_list<IOPIN *> pins, Pull pull);

    bool level() const { return end_.level; }
    // Called with the new level at each change.
    void watch(std::function<void(bool)> watcher) { end_.watcher = std::move(watcher); }
    // Drive it from outside, harder than any pin can, or let go.
    void drive(bool level);
    void release();

private:
    // The outside end of the wire: a resistor to one rail, or a driver.
    struct End : stimulus {
        explicit End(const char *name) : stimulus(name, 0.0, 0.0) {}
        void set_nodeVoltage(double volts) override;
        bool level = false;
        std::function<void(bool)> watcher;
    };
    Stimulus_Node *node_;
    End end_;
    double pull_volts_;
};

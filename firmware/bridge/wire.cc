#include "wire.h"

#include <string>

namespace {
constexpr double kSupplyVolts = 5.0;
constexpr double kThresholdVolts = 2.5;
constexpr double kPullOhms = 10e3;
constexpr double kDriverOhms = 1.0;
}  // namespace

Wire::Wire(const char *name, std::initializer_list<IOPIN *> pins, Pull pull)
    : node_(new Stimulus_Node(name)),
      end_((std::string(name) + "_end").c_str()),
      pull_volts_(pull == Pull::kUp ? kSupplyVolts : 0.0) {
    for (IOPIN *pin : pins) node_->attach_stimulus(pin);
    node_->attach_stimulus(&end_);
    release();
}

void Wire::drive(bool level) {
    end_.set_Vth(level ? kSupplyVolts : 0.0);
    end_.set_Zth(kDriverOhms);
    node_->update();
}

void Wire::release() {
    end_.set_Vth(pull_volts_);
    end_.set_Zth(kPullOhms);
    node_->update();
}

void Wire::End::set_nodeVoltage(double volts) {
    const bool was = level;
    level = volts > kThresholdVolts;
    if (level != was && watcher) watcher(level);
}

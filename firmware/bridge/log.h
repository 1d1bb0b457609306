// What the bridge says: one JSON object a line, each with the instruction cycle it belongs to.
#pragma once

#include <cstdint>
#include <string>

constexpr double kCyclesPerSecond = 7372800.0;  // 7.3728 MHz crystal, x4, 4 clocks a cycle
constexpr uint64_t kCyclesPerBit = 64;          // at 115200 baud

uint64_t now();  // instruction cycles since power-on

// Take standard output for ourselves: gpsim prints banners there, which go to standard error now.
void log_open();
// `fields` is the inside of a JSON object, without braces.
void log_event(const std::string &fields);
void log_flush();

// Runs the firmware's image in gpsim, between a serial line and two AD9833.
//
//   bridge IMAGE.hex --pty    in real time, the line on a pseudo-terminal that it names
//   bridge IMAGE.hex          as fast as it can, under the commands on standard input:
//       send HEX [CYCLE]      bytes for the board, from now on or from a cycle on
//       run CYCLE             go on to that cycle
//       answer CYCLE          go on until the board has sent a zero byte; or, where it is not
//                             sending, to that cycle
//       reset CAUSE           power_on, brown_out, external, watchdog, ...
//       register ADDRESS VALUE    as a disturbance would: both in hexadecimal
//       goto ADDRESS          the same with the program counter
//       sdata 0|1|free        hold the data line to the chips, or let it go
//       measure               times on the bus, interrupt time, stack
//
// Everything that happens is a JSON line on standard output; each command's last has "done".

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "ad9833.h"
#include "log.h"
#include "pic.h"
#include "uart.h"
#include "wire.h"

namespace {

constexpr double kStartUpSeconds = 1e-3;  // the firmware listens before a host can speak
constexpr double kMostBehindSeconds = 0.02;
constexpr uint64_t kLongestReply = 50 * 10 * kCyclesPerBit;

void log_word(const std::string &chips, const Ad9833 &chip) {
    log_event("\"chips\": \"" + chips + "\", \"word\": " + std::to_string(chip.word()) +
              ", \"latched\": " + std::to_string(chip.latched()));
}

struct Board {
    explicit Board(const std::string &image)
        : pic(image),
          rx("rx", {pic.port_pin('c', 7)}, Wire::Pull::kUp),
          tx("tx", {pic.port_pin('c', 6)}, Wire::Pull::kUp),
          fsync_a("fsync_a", {pic.port_pin('c', 0)}, Wire::Pull::kUp),
          fsync_b("fsync_b", {pic.port_pin('c', 1)}, Wire::Pull::kUp),
          enable("enable", {pic.port_pin('c', 2)}, Wire::Pull::kDown),
          sclk("sclk", {pic.port_pin('c', 3)}, Wire::Pull::kUp),
          sdata("sdata", {pic.port_pin('c', 5), pic.port_pin('c', 4)}, Wire::Pull::kDown),
          sync("sync", {pic.port_pin('b', 0)}, Wire::Pull::kDown),
          a('a'), b('b'), sender(rx), receiver(tx) {
        // RC0 and RC1 rise one after the other within one instruction: a word for both is one line.
        fsync_a.watch([this](bool level) {
            if (pic.resetting()) return a.abandon();
            if (!a.fsync(level, sclk.level())) return;
            a_waits = b.selected();
            if (!a_waits) log_word("a", a);
        });
        fsync_b.watch([this](bool level) {
            if (pic.resetting()) return b.abandon();
            if (!b.fsync(level, sclk.level())) return;
            const bool same = a_waits && a.latched() == b.latched();
            if (a_waits && !same) log_word("a", a);
            log_word(same ? "ab" : "b", b);
            a_waits = false;
        });
        sclk.watch([this](bool level) {
            a.clock(level, sdata.level());
            b.clock(level, sdata.level());
        });
        pic.on_restart = [this] { receiver.abandon(); };
        sdata.watch([this](bool) { a.data(), b.data(); });
        enable.watch([](bool level) { log_event(level ? "\"enable\": 1" : "\"enable\": 0"); });
        sync.watch([](bool level) { log_event(level ? "\"sync\": 1" : "\"sync\": 0"); });
    }

    Pic pic;
    Wire rx, tx, fsync_a, fsync_b, enable, sclk, sdata, sync;
    Ad9833 a, b;
    HostSender sender;
    HostReceiver receiver;
    bool a_waits = false;
};

void log_measured(Board &board) {
    const BusTimes &a = board.a.times(), &b = board.b.times();
    const auto least = [&](uint64_t BusTimes::*time) { return std::to_string(std::min(a.*time, b.*time)); };
    log_event("\"data_set_up\": " + least(&BusTimes::data_set_up) +
              ", \"data_hold\": " + least(&BusTimes::data_hold) +
              ", \"clock_high\": " + least(&BusTimes::clock_high) +
              ", \"clock_low\": " + least(&BusTimes::clock_low) +
              ", \"fsync_set_up\": " + least(&BusTimes::fsync_set_up) +
              ", \"fsync_hold\": " + least(&BusTimes::fsync_hold) +
              ", \"clock_to_fsync\": " + least(&BusTimes::clock_to_fsync) +
              ", \"interrupt\": " + std::to_string(board.pic.measured().interrupt_cycles) +
              ", \"masked\": " + std::to_string(board.pic.measured().masked_cycles) +
              ", \"stack\": " + std::to_string(board.pic.measured().stack_levels));
}

void send_hex(Board &board, const std::string &hex, uint64_t cycle) {
    for (size_t i = 0; i + 1 < hex.size(); i += 2)
        board.sender.send(static_cast<uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)), cycle);
}

void answer(Board &board, uint64_t cycle) {
    auto &received = board.receiver.received;
    received.clear();
    while (now() < cycle || (!received.empty() && now() < cycle + kLongestReply)) {
        board.pic.run_until(now() + kCyclesPerBit);
        if (!received.empty() && received.back() == 0) return;
    }
}

bool obey(Board &board, const std::string &line) {
    std::istringstream words(line);
    std::string command, text;
    uint64_t cycle = 0;
    unsigned address = 0, value = 0;
    words >> command;
    if (command == "run" && words >> cycle) board.pic.run_until(cycle);
    else if (command == "answer" && words >> cycle) answer(board, cycle);
    else if (command == "send" && words >> text) send_hex(board, text, words >> cycle ? cycle : 0);
    else if (command == "measure") log_measured(board);
    else if (command == "register" && words >> std::hex >> address >> value)
        board.pic.write_register(address, value);
    else if (command == "goto" && words >> std::hex >> address) board.pic.set_program_counter(address);
    else if (command == "sdata" && words >> text) {
        if (text == "free") board.sdata.release();
        else board.sdata.drive(text == "1");
    } else if (command == "reset" && words >> text && cause_named(text)) board.pic.restart(*cause_named(text));
    else return false;
    log_event("\"done\": 1");
    log_flush();
    return true;
}

int run_commands(Board &board) {
    for (std::string line; std::getline(std::cin, line);) {
        if (obey(board, line)) continue;
        fprintf(stderr, "bridge: cannot do: %s\n", line.c_str());
        return 2;
    }
    return 0;
}

double seconds() {
    timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Bits are as long as the host's end makes them, so that a wrong baud rate shows as it would.
void follow_baud(Board &board, int terminal) {
    static const struct { speed_t code; unsigned baud; } kRates[] = {
        {B9600, 9600}, {B19200, 19200}, {B38400, 38400}, {B57600, 57600}, {B115200, 115200}, {B230400, 230400}};
    termios settings;
    if (tcgetattr(terminal, &settings)) return;
    for (const auto &rate : kRates)
        if (rate.code == cfgetospeed(&settings))
            board.sender.bit_cycles = board.receiver.bit_cycles = static_cast<uint64_t>(kCyclesPerSecond) / rate.baud;
}

int run_terminal(Board &board) {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (terminal < 0 || grantpt(terminal) || unlockpt(terminal)) return perror("bridge: pty"), 3;
    const int other_end = open(ptsname(terminal), O_RDWR | O_NOCTTY);  // keeps it up between hosts
    termios settings;
    tcgetattr(other_end, &settings);
    cfmakeraw(&settings);
    cfsetspeed(&settings, B115200);
    tcsetattr(other_end, TCSANOW, &settings);
    board.pic.run_until(static_cast<uint64_t>(kStartUpSeconds * kCyclesPerSecond));
    log_event(std::string("\"pty\": \"") + ptsname(terminal) + "\"");
    log_flush();
    double start = seconds() - kStartUpSeconds;
    for (;;) {
        // Wakes for the host's bytes, every half millisecond for time, and ends with its parent.
        pollfd watched[] = {{terminal, POLLIN, 0}, {STDIN_FILENO, 0, 0}};
        timespec nap = {0, 500000};
        ppoll(watched, 2, &nap, nullptr);
        if (watched[1].revents & (POLLHUP | POLLERR)) return 0;
        // What a stopped or busy machine missed is left out, not caught up: replies would come late.
        const double reached = static_cast<double>(now()) / kCyclesPerSecond;
        start = std::max(start, seconds() - reached - kMostBehindSeconds);
        board.pic.run_until(static_cast<uint64_t>((seconds() - start) * kCyclesPerSecond));
        follow_baud(board, terminal);
        unsigned char bytes[256];
        const ssize_t count = read(terminal, bytes, sizeof bytes);
        for (ssize_t i = 0; i < count; ++i) board.sender.send(bytes[i], now());
        for (auto &received = board.receiver.received; !received.empty(); received.pop_front())
            if (write(terminal, &received.front(), 1) != 1) break;
        log_flush();
    }
}

}  // namespace

int main(int argc, char **argv) {
    const bool terminal = argc == 3 && std::string(argv[2]) == "--pty";
    if (argc != 2 && !terminal) {
        fprintf(stderr, "usage: bridge IMAGE.hex [--pty]\n");
        return 2;
    }
    log_open();
    try {
        initialize_gpsim_core();
        Board board(argv[1]);
        const int status = terminal ? run_terminal(board) : run_commands(board);
        log_flush();
        _exit(status);  // gpsim's own destructors take seconds
    } catch (const std::exception &failure) {
        fprintf(stderr, "bridge: %s\n", failure.what());
        return 3;
    }
}

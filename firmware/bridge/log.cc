#include "log.h"

#include <cstdio>
#include <unistd.h>

#include <gpsim_time.h>

namespace {
FILE *out = nullptr;
}

uint64_t now() { return get_cycles().get(); }

void log_open() {
    out = fdopen(dup(STDOUT_FILENO), "w");
    dup2(STDERR_FILENO, STDOUT_FILENO);
}

void log_event(const std::string &fields) {
    fprintf(out, "{\"cycle\": %llu, %s}\n", static_cast<unsigned long long>(now()), fields.c_str());
}

void log_flush() { fflush(out); }

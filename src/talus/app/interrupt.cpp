#include "talus/app/interrupt.hpp"

#include <csignal>

namespace talus {

namespace {

constexpr int noted_signals[] = {SIGINT, SIGTERM};
volatile std::sig_atomic_t came = 0;

void set(int number, void (*handler)(int)) {
  struct sigaction action {
  }, before{};
  sigaction(number, nullptr, &before);
  if (before.sa_handler == SIG_IGN) return;
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(number, &action, nullptr);
}

void note(int number) {
  came = number;
  for (int each : noted_signals) set(each, SIG_DFL);
}

}  // namespace

Interrupt::Interrupt() {
  came = 0;
  for (int each : noted_signals) set(each, note);
}

Interrupt::~Interrupt() {
  for (int each : noted_signals) set(each, SIG_DFL);
}

int Interrupt::signal() const { return came; }

}  // namespace talus

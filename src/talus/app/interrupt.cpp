#include "talus/app/interrupt.hpp"

#include <csignal>

namespace talus {

namespace {

constexpr int signals[] = {SIGINT, SIGTERM};
volatile std::sig_atomic_t received = 0;

void set_handler(int number, void (*handler)(int)) {
  struct sigaction action {
  }, before{};
  sigaction(number, nullptr, &before);
  if (before.sa_handler == SIG_IGN) return;
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(number, &action, nullptr);
}

void receive(int number) {
  received = number;
  for (int each : signals) set_handler(each, SIG_DFL);
}

}  // namespace

Interrupt::Interrupt() {
  received = 0;
  for (int each : signals) set_handler(each, receive);
}

Interrupt::~Interrupt() {
  for (int each : signals) set_handler(each, SIG_DFL);
}

int Interrupt::signal() const { return received; }

}  // namespace talus

#include "talus/app/interrupt.hpp"

#include <csignal>
#include <iterator>

namespace talus {

namespace {

constexpr int signals[] = {SIGINT, SIGTERM};
struct sigaction before[std::size(signals)];
volatile std::sig_atomic_t received = 0;

void set_handler(int number, void (*handler)(int)) {
  struct sigaction action {
  }, present{};
  sigaction(number, nullptr, &present);
  if (present.sa_handler == SIG_IGN) return;
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(number, &action, nullptr);
}

void restore_handlers() {
  for (std::size_t i = 0; i < std::size(signals); ++i) sigaction(signals[i], &before[i], nullptr);
}

void receive(int number) {
  received = number;
  restore_handlers();
}

}  // namespace

Interrupt::Interrupt() {
  received = 0;
  for (std::size_t i = 0; i < std::size(signals); ++i) {
    sigaction(signals[i], nullptr, &before[i]);
    set_handler(signals[i], receive);
  }
}

Interrupt::~Interrupt() { restore_handlers(); }

int Interrupt::signal() const { return received; }

}  // namespace talus

#include "patches/io/occt_session.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <OSD.hxx>
#include <array>
#include <cfenv>
#include <csignal>
#include <iostream>
#include <vector>

namespace iso::occt {
namespace {

// All signals for which Open CASCADE may install a handler. SIGINT stays with the program throughout.
constexpr std::array kSignals{SIGFPE, SIGSEGV, SIGBUS, SIGILL, SIGSYS, SIGHUP, SIGQUIT, SIGTERM, SIGINT};
constexpr size_t kHandlerStack = 256 << 10;  // bytes

}  // namespace

struct Session::State {
  std::array<struct sigaction, kSignals.size()> handlers{};
  std::fenv_t floating_point{};
  std::streambuf *out = nullptr, *err = nullptr;
  Message_SequenceOfPrinters printers;
  std::vector<char> stack = std::vector<char>(kHandlerStack);
  stack_t stack_before{};
};

Session::Session() : state_(std::make_unique<State>()) {
  // Most messages go through printers, a few straight to the streams.
  state_->printers = Message::DefaultMessenger()->Printers();
  Message::DefaultMessenger()->ChangePrinters().Clear();
  std::cout.flush();
  state_->out = std::cout.rdbuf(nullptr);
  state_->err = std::cerr.rdbuf(nullptr);

  std::fegetenv(&state_->floating_point);
  for (size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], nullptr, &state_->handlers[i]);
  OSD::SetSignal(Standard_False);
  for (size_t i = 0; i < kSignals.size(); ++i)
    if (kSignals[i] == SIGINT || kSignals[i] == SIGTERM || kSignals[i] == SIGHUP || kSignals[i] == SIGQUIT)
      sigaction(kSignals[i], &state_->handlers[i], nullptr);

  // An entity of a damaged file that contains itself ends in a stack overflow: the handler needs a stack of its own.
  stack_t own{};
  own.ss_sp = state_->stack.data();
  own.ss_size = state_->stack.size();
  sigaltstack(&own, &state_->stack_before);
  for (const int signal : {SIGSEGV, SIGBUS}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    action.sa_flags |= SA_ONSTACK;
    sigaction(signal, &action, nullptr);
  }
}

Session::~Session() {
  for (size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &state_->handlers[i], nullptr);
  sigaltstack(&state_->stack_before, nullptr);
  std::fesetenv(&state_->floating_point);
  std::cout.rdbuf(state_->out);
  std::cerr.rdbuf(state_->err);
  Message::DefaultMessenger()->ChangePrinters() = state_->printers;
}

}  // namespace iso::occt

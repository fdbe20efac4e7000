#include "patches/io/occt_session.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <OSD.hxx>
#include <array>
#include <cfenv>
#include <csignal>
#include <iostream>

namespace iso::occt {
namespace {

// All signals for which Open CASCADE may install a handler. SIGINT stays with the program throughout.
constexpr std::array kSignals{SIGFPE, SIGSEGV, SIGBUS, SIGILL, SIGSYS, SIGHUP, SIGQUIT, SIGTERM, SIGINT};

}  // namespace

struct Session::State {
  std::array<struct sigaction, kSignals.size()> handlers{};
  std::fenv_t floating_point{};
  std::streambuf *out = nullptr, *err = nullptr;
  Message_SequenceOfPrinters printers;
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
}

Session::~Session() {
  for (size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &state_->handlers[i], nullptr);
  std::fesetenv(&state_->floating_point);
  std::cout.rdbuf(state_->out);
  std::cerr.rdbuf(state_->err);
  Message::DefaultMessenger()->ChangePrinters() = state_->printers;
}

}  // namespace iso::occt

// The program `isophote`: its subcommands, its exit codes, and what it says when nobody else did.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#include <optional>

#include "raytracer/cmd/command.h"
#include "raytracer/json_reader.h"

namespace iso {

Exit fail(const Error& error) {
  // One line, whatever a library put into its message.
  std::string text = error.text();
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  fmt::print(stderr, "isophote: {}\n", text);
  return error.kind;
}

Exit tell_broken(const std::vector<std::string>& broken, const std::string& file) {
  constexpr std::size_t kMostLines = 8;
  for (std::size_t i = 0; i < std::min(broken.size(), kMostLines); ++i) fail({Exit::promise_not_kept, file, {}, broken[i]});
  if (broken.size() > kMostLines) fail({Exit::promise_not_kept, file, {}, fmt::format("and {} more", broken.size() - kMostLines)});
  return broken.empty() ? Exit::done : Exit::promise_not_kept;
}

Status write_stdout(std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(STDOUT_FILENO, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return read_write_error("standard output", fmt::format("writing failed: {}", std::strerror(errno)));
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return Done{};
}

namespace {

struct PlannedCommand {
  const char *name, *does;
};
constexpr PlannedCommand kPlanned[] = {
    {"convert", "B-rep to a globally smooth spline"}, {"vectorise", "raster image to a vector image"}, {"preview", "interactive window"}};

void add_planned_commands(CLI::App& app, Exit& exit) {
  for (const PlannedCommand& planned : kPlanned) {
    CLI::App* command = app.add_subcommand(planned.name, planned.does)->group("Not available yet")->allow_extras();
    command->callback([&exit, planned] {
      exit =
          fail({Exit::bad_command_line, {}, {}, fmt::format("'{}' is not available yet; `isophote --help` lists what is", planned.name)});
    });
  }
}

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 done, but a promise or threshold was not kept; 2 bad command line; 3 bad input;\n"
    "            4 could not read or write; 130 interrupted.\n"
    "Data goes to standard output, progress and messages to standard error.";

// The error for a first word that is no command, if it is none.
std::optional<Error> unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<const char*> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_name() == word) return {};
    names.push_back(command->get_name().c_str());
  }
  const auto meant = did_you_mean(word, names);
  return Error{
      Exit::bad_command_line,
      {},
      {},
      fmt::format("unknown command '{}'; {}", word, meant ? fmt::format("did you mean '{}'?", *meant) : "`isophote --help` lists them")};
}

Exit run(int argc, char** argv) {
  CLI::App app{"Isophote: an offline ray tracer of exact trimmed CAD surfaces", "isophote"};
  Exit exit = Exit::done;
  app.set_version_flag("--version", std::string("isophote ") + kVersion);
  app.footer(kFooter);
  app.require_subcommand(1);
  add_render_command(app, exit);
  add_hit_command(app, exit);
  add_info_command(app, exit);
  add_display_command(app, exit);
  add_tessellate_command(app, exit);
  add_compare_command(app, exit, {argv + std::min(argc, 2), argv + argc});
  add_continuity_command(app, exit);
  add_diff_command(app, exit);
  add_planned_commands(app, exit);
  if (argc > 1 && argv[1][0] != '-')
    if (const auto error = unknown_command(app, argv[1])) return fail(*error);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {  // --help, --version
    app.exit(e);
  } catch (const CLI::ParseError& e) {
    return fail({Exit::bad_command_line, {}, {}, fmt::format("{} (`isophote --help` lists commands and options)", e.what())});
  }
  return exit;
}

}  // namespace
}  // namespace iso

int main(int argc, char** argv) {
  // A closed pipe or a file-size limit shows as a failed write, which is reported; the default would be to die silently.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return static_cast<int>(iso::run(argc, argv));
  } catch (const std::bad_alloc&) {
    return static_cast<int>(iso::fail({iso::Exit::read_write, {}, {}, "not enough memory"}));
  } catch (const std::exception& e) {
    return static_cast<int>(iso::fail(iso::bad_input({}, {}, std::string("unexpected trouble: ") + e.what())));
  }
}

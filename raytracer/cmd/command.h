// What the subcommands share: how they join the program, and how they speak.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "patches/base/result.h"

namespace iso {

inline constexpr const char* kVersion = ISOPHOTE_VERSION;

// Each adds a subcommand, which leaves its exit code in `exit` when it is the one that was asked for.
void add_render_command(CLI::App& app, Exit& exit);
void add_hit_command(CLI::App& app, Exit& exit);
void add_info_command(CLI::App& app, Exit& exit);
void add_display_command(CLI::App& app, Exit& exit);
void add_tessellate_command(CLI::App& app, Exit& exit);
// `words`: the command line after the command, for the report.
void add_compare_command(CLI::App& app, Exit& exit, const std::vector<std::string>& words);
void add_continuity_command(CLI::App& app, Exit& exit);
void add_diff_command(CLI::App& app, Exit& exit);

// Says the error on stderr, one line, and gives its exit code.
Exit fail(const Error& error);

// Says which promises about a file are not kept, the first few lines of them, and gives Exit::promise_not_kept; Exit::done if there are
// none.
Exit tell_broken(const std::vector<std::string>& broken, const std::string& file);

// Writes to standard output; an error is said unless the reader just went away.
Status write_stdout(std::string_view text);

}  // namespace iso

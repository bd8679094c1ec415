#include "analysis/report/figure.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string_view>
#include <utility>

#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"
#include "core/atomic_file.hpp"
#include "core/cancellation.hpp"
#include "core/error.hpp"
namespace twincell::analysis {
namespace {

void run_gnuplot(const std::filesystem::path& folder, const std::string& script) {
  const std::string messages = (folder / (script + ".log")).string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, (script + ".log").c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_addclosefrom_np(&actions,
                                           3);  // gnuplot must not inherit files, locks and pipes
  std::string program = "gnuplot", argument = script;
  std::array<char*, 3> arguments = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT)
    throw RunError("Figures are drawn by gnuplot, which is not installed (Debian: gnuplot-nox).");
  if (failure != 0) throw RunError(fmt::format("gnuplot could not be started: {}.", std::strerror(failure)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw RunError(fmt::format("Waiting for gnuplot failed: {}.", std::strerror(errno)));
    if (cancellation_requested() == 0 || finishing_first()) continue;
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    throw_if_cancelled();
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::string words = read_text_file(messages);
    std::replace(words.begin(), words.end(), '\n', ' ');
    throw RunError(fmt::format("gnuplot failed on {}: {}", script, words.substr(0, 400)));
  }
  std::filesystem::remove(messages);
}

/// gnuplot does not tell that a disk is full or a file too large for its limit; the end of the picture does.
void require_whole(const std::filesystem::path& picture, const std::string& last_words) {
  constexpr std::streamoff kTail = 64;  // bytes
  std::ifstream stream(picture, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : 0;
  std::string tail(static_cast<std::size_t>(std::min(size, kTail)), '\0');
  stream.seekg(size - static_cast<std::streamoff>(tail.size()));
  stream.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  if (tail.find(last_words) == std::string::npos)
    throw RunError(
        fmt::format("{}: gnuplot did not finish the picture: no space is left, or files may not be as large.",
                    picture.string()));
}

}  // namespace

std::vector<std::string> figure_files(const std::string& name) {
  std::vector<std::string> files;
  for (const char* ending : {".dat", ".gp", ".svg", ".pdf", ".png"}) files.push_back(name + ending);
  return files;
}

void draw(const Figure& figure, const std::filesystem::path& folder) {
  if (!is_figure_name(figure.name))
    throw RunError(
        fmt::format("A figure cannot be named '{}': letters, digits, '_', '-' and '.' only.", figure.name));
  const bool own_svg = !figure.svg.empty();
  std::string script = fmt::format("# {0}\n# gnuplot {1}.gp draws {2}\ndo for [kind in '{3}'] {{\n",
                                   gnuplot_plain_text(figure.title), figure.name,
                                   own_svg ? fmt::format("{0}.pdf and {0}.png", figure.name)
                                           : fmt::format("{0}.svg, {0}.pdf and {0}.png", figure.name),
                                   own_svg ? "pdf png" : "svg pdf png");
  for (const char* kind : {"svg", "pdf", "png"})
    if (!own_svg || kind != std::string_view("svg"))
      script += fmt::format("if (kind eq '{}') {{\n  {}}}\n", kind,
                            figure_style::terminal(kind, figure.width, figure.height));
  script += fmt::format("set output '{}.' . kind\n{}{}unset output\nreset\n}}\n", figure.name,
                        figure_style::head(), figure.plot);
  write_text_file(folder / (figure.name + ".dat"), figure.data);
  write_text_file(folder / (figure.name + ".gp"), script);
  if (own_svg) write_text_file(folder / (figure.name + ".svg"), figure.svg);
  run_gnuplot(folder, figure.name + ".gp");
  for (const auto& [kind, last_words] :
       {std::pair{"svg", "</svg>"}, std::pair{"pdf", "%%EOF"}, std::pair{"png", "IEND"}})
    require_whole(folder / fmt::format("{}.{}", figure.name, kind), last_words);
}

}  // namespace twincell::analysis

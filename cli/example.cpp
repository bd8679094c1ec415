// twincell example DIR: copies the inputs of the documented examples into a folder.

#include <fmt/format.h>
#include <sys/auxv.h>

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <memory>
#include <system_error>

#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"

namespace twincell::cli {

namespace {

namespace fs = std::filesystem;

/// An input: where it is in the data folder, what it is called in the example folder, and for what it serves.
struct Input {
  const char* source;
  const char* name;
  const char* purpose;
};

constexpr std::array kInputs = {
    Input{"demo/gamma-1.6", "frames", "a stack of frames: new, info, locate, track, match, calibrate"},
    Input{"demo/gamma-0.9", "gamma-0.9", "the same cell at Gamma = 0.9: match with several strengths"},
    Input{"demo/gamma-1.6", "gamma-1.6", "the same cell at Gamma = 1.6"},
    Input{"demo/twin.toml", "twin.toml", "contact model of the twins: match --scene"},
    Input{"example/scene.toml", "scene.toml", "a small bed: explain, simulate, export, calibrate infer"},
    Input{"example/recorded.toml", "recorded.toml", "a bed on a recorded plate: explain, simulate"},
    Input{"example/plate.csv", "plate.csv", "the accelerometer's record of that plate"},
    Input{"example/few.toml", "few.toml", "a bed to render: simulate, render"},
    Input{"example/CAMERA.toml", "CAMERA.toml", "a camera with lens faults and dust: render --camera"},
    Input{"example/gas.toml", "gas.toml", "a dilute gas: measure"},
    Input{"example/gas_plan.toml", "gas_plan.toml", "its temperature against the drive: sweep"},
    Input{"example/plan.toml", "plan.toml", "a search for the onset of bouncing: sweep"},
    Input{"example/bounce.csv", "bounce.csv", "heights of a bouncing bead: calibrate contacts bounce"},
    Input{"example/p_s.csv", "p_s.csv", "slip frequencies: fit"},
    Input{"vibrated-gas/own.csv", "own.csv", "points of a user: reproduce --data"},
    Input{"example/dump.lammpstrj", "dump.lammpstrj", "a run of LAMMPS: import"},
    Input{"example/README.md", "README.md", "what each file contains, with the known answers"},
};

Product example_folder() {
  return Product::whole_folder("a folder of examples");
}

/// Folder of the shipped data: next to the installed program, otherwise in the source from which it was
/// built. \throws InputError if neither exists
fs::path data_folder() {
  std::error_code ec;
  fs::path program = fs::read_symlink("/proc/self/exe", ec);
  // Without /proc, as in some chroots: the name under which the kernel started the program.
  if (program.empty())
    if (const unsigned long name = getauxval(AT_EXECFN); name != 0)
      program = fs::absolute(reinterpret_cast<const char*>(name), ec);
  const fs::path installed = program.parent_path().parent_path() / "share/twincell/data_samples";
  for (const fs::path& folder : {installed, fs::path(TWINCELL_DATA_SAMPLES)})
    if (fs::is_directory(folder / "example", ec)) return folder;
  throw InputError({installed.string(), 0, 0, ""},
                   fmt::format("the folder of the example inputs is missing, and so is {}; install twincell "
                               "again.",
                               TWINCELL_DATA_SAMPLES));
}

/// Why a copy failed. The C++ library reports a full disk as an error of input or output.
std::string reason_of(const std::error_code& error, const fs::path& folder) {
  constexpr std::uintmax_t kFull = 1 << 16;  // bytes, less than the largest input
  std::error_code unknown;
  const fs::space_info space = fs::space(folder, unknown);
  return !unknown && space.available < kFull ? "No space left on device" : error.message();
}

void run(const std::string& output, const Common& common) {
  const fs::path data = data_folder();
  AtomicPath folder(output, example_folder());
  std::string text = fmt::format(
      "{}: inputs for every command; the examples of the documentation and of "
      "--help run in this folder\n",
      output);
  nlohmann::json files = nlohmann::json::object();
  for (const Input& input : kInputs) {
    std::error_code ec;
    fs::copy(data / input.source, folder.part() / input.name, fs::copy_options::recursive, ec);
    if (ec)
      throw RunError(fmt::format("{}: cannot be copied to {}: {}.", (data / input.source).string(), output,
                                 reason_of(ec, folder.part())));
    text += fmt::format("  {:<15} {}\n", input.name, input.purpose);
    files[input.name] = input.purpose;
  }
  folder.commit();
  const std::string where = shell_word(output);
  text += fmt::format("next: cd {} && twincell new frames -o CELL.toml --drive-gamma 1.6\n", where);
  print_result(common, {{"output", output}, {"files", files}}, text);
}

}  // namespace

void add_example(CLI::App& program, Common& common) {
  auto output = std::make_shared<std::string>();
  CLI::App& verb = add_verb(program, common, "example",
                            "Copy small example inputs for every command into a folder. The examples of the "
                            "documentation and of --help run there as printed.",
                            "twincell example first-hour");
  writes(common, verb, verb.add_option("folder", *output, "Folder to write")->required(), example_folder());
  verb.callback([output, &common] { run(*output, common); });
}

}  // namespace twincell::cli

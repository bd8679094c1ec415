// Fuzz target: a plan of a sweep over the existing scene "scene.toml". An input that contains a NUL supplies
// its own scene after it.

#include <algorithm>
#include <fstream>

#include "sweep/plan.hpp"
#include "tests/fuzz/input.hpp"

namespace {

/// A temporary folder of this process, removed at exit.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "twincell-fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  static const Folder folder;
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = std::min(all.find('\0'), size);
  std::ofstream(folder.path() / "scene.toml", std::ios::binary)
      << (cut < size ? all.substr(cut + 1) : "preset = \"fortini-huang-2015\"\n[beads]\ncount = 20\n");
  fuzz::accept_or_refuse(
      [&] { (void)sweep::read_plan_text(std::string(all.substr(0, cut)), "plan.toml", folder.path()); });
  return 0;
}

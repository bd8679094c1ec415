// The readers whose headers we parse, on whatever bytes. A program per format: TWINCELL_FUZZ_READER is its
// name. An input may be refused in a sentence; it must not crash, hang, or ask for memory that its size
// cannot explain.

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "imaging/stack/formats/reader.hpp"
#include "tests/fuzz/input.hpp"

namespace twincell::frames {
extern const Reader cine_reader, seq_reader, mrf_reader, mraw_reader, tiff_reader;
}

namespace {

namespace fs = std::filesystem;
using twincell::frames::Reader;

constexpr std::string_view kFormat = TWINCELL_FUZZ_READER;

const Reader& reader() {
  using namespace twincell::frames;
  return kFormat == "cine"   ? cine_reader
         : kFormat == "seq"  ? seq_reader
         : kFormat == "mrf"  ? mrf_reader
         : kFormat == "mraw" ? mraw_reader
                             : tiff_reader;
}

/// A .cih and its .mraw, for which the name matters: the input up to its first NUL, and the rest.
class PhotronPair {
 public:
  PhotronPair() {
    std::string name = (fs::temp_directory_path() / "twincell-fuzz-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  PhotronPair(const PhotronPair&) = delete;
  PhotronPair& operator=(const PhotronPair&) = delete;
  ~PhotronPair() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  [[nodiscard]] fs::path write(const std::uint8_t* data, std::size_t n) const {
    const std::string_view all(reinterpret_cast<const char*>(data), n);
    const std::size_t cut = std::min(all.find('\0'), n);
    std::ofstream(folder_ / "a.cih", std::ios::binary) << all.substr(0, cut);
    std::ofstream(folder_ / "a.mraw", std::ios::binary) << all.substr(std::min(cut + 1, n));
    return folder_ / "a.mraw";
  }

 private:
  fs::path folder_;
};

void read_stack(const fs::path& file) {
  try {
    const auto source = reader().open(file, "");
    (void)source->info();
    cv::Mat frame;
    // A small file may well hold millions of frames of one pixel.
    for (int i = 0; i < 64 && source->next(frame); ++i) {
      if (frame.empty() || frame.channels() != 1) std::abort();
      (void)source->time_s();
      (void)source->current();
    }
  } catch (const twincell::InputError& e) {
    // One sentence that names the file.
    if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (kFormat == "mraw") {
    static const PhotronPair pair;
    read_stack(pair.write(data, size));
  } else {
    read_stack(twincell::fuzz::MemoryFile(data, size).path());
  }
  return 0;
}

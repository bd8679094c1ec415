// Redlake/IDT .mrf, "Multi-page Raw Format": "IDT-MRF", a header whose length the file states, then planes.
// Layout: IDT camera manual, appendix; tlhedrick/dltdv DLTdv8a_internal/mrfInfo.m, which is used with files
// of real cameras.

#include <fmt/format.h>

#include "imaging/stack/formats/raw_stack.hpp"
#include "imaging/stack/formats/reader.hpp"

namespace twincell::imaging::frames {

namespace {

class Mrf final : public RawStack {
 public:
  explicit Mrf(const std::filesystem::path& file) : RawStack(file) {
    const std::string header = "the header";
    // The manual states 84 bytes for the structure but prints one of 276. The field in the file is right.
    first_ = 12 + std::uint64_t{in_.u32(12, header)};
    frames_ = in_.u32(16, header);
    const std::uint32_t width = in_.u32(20, header), height = in_.u32(24, header), bits = in_.u32(28, header);
    if (!(bits >= 8 && bits <= 16) && bits != 24)
      in_.refuse(fmt::format("has {} bits per pixel; 8 to 16, or 24, can be read.", bits));
    set_layout(width, height, bits == 24 ? 24 : bits == 8 ? 8 : 16);
    info_.bits = bits == 24 ? 8 : static_cast<int>(bits);
    info_.format = fmt::format("IDT multi-page raw, {} bit", layout_.stored_bits);
    require_frames();
    require_last(place(frames_ - 1));
  }

 private:
  [[nodiscard]] std::uint64_t place(std::uint64_t i) const override { return first_ + i * layout_.bytes(); }

  std::uint64_t first_ = 0;
};

}  // namespace

extern const Reader mrf_reader;
const Reader mrf_reader = {
    .extensions = ".mrf",
    .owns = [](const Head& head) { return head.starts_with("IDT-MRF"); },
    .open = [](const std::filesystem::path& file, const std::string&) -> std::unique_ptr<FrameSource> {
      return std::make_unique<Mrf>(file);
    }};

}  // namespace twincell::imaging::frames

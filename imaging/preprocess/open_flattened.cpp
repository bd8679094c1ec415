#include "imaging/preprocess/open_flattened.hpp"

#include "core/error.hpp"
#include "imaging/preprocess/flat_field.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::imaging {

std::unique_ptr<FrameSource> flattened_by(std::unique_ptr<FrameSource> frames,
                                          const std::filesystem::path& stack, const std::string& flat) {
  if (flat.empty()) return frames;
  return flattened(std::move(frames), flat == "stack"
                                          ? flat_of_stack(*open_frames(stack), *open_frames(stack))
                                          : flat_of_blank(*open_frames(flat)));
}

void check_flat(const std::string& flat, bool bright) {
  if (flat == "stack" && bright)
    throw ConfigError(Where{.file = {}, .key = "--flat"},
                      "'stack' uses the light between dark beads, but these beads are brighter than the "
                      "background; give frames of the cell without beads.");
}

}  // namespace twincell::imaging

#pragma once
/// \file
/// What a stack of frames holds, for `info` and for those who open one.

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "imaging/frame_source.hpp"

namespace twincell::cli {

struct Common;

/// open_frames(), with the stack's notes on stderr.
std::unique_ptr<FrameSource> open_stack(const std::filesystem::path& stack, const Common& common);

/// An HDF5 file with a group h5md; what is named .h5 and is no HDF5 counts as one too, to be refused as such.
bool is_trajectory(const std::filesystem::path& file);

/// Format, size, frames, depth, times, and the values of the first frame. \throws InputError as open_frames()
nlohmann::json describe_stack(const std::filesystem::path& stack);
std::string stack_as_text(const nlohmann::json& description);

}  // namespace twincell::cli

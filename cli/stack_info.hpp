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

/// Format, size, frames, depth, times, and the values of the first frame. \throws InputError as open_frames()
nlohmann::json describe_stack(const std::filesystem::path& stack);
std::string stack_as_text(const nlohmann::json& description);

}  // namespace twincell::cli

#pragma once
/// \file
/// Options of the verbs that locate beads: locate, track and match have the same.

#include <memory>
#include <string>

#include "imaging/track/locating_request.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

struct Common;

/// Adds the options of a request to a verb.
void add_locating_options(CLI::App& verb, imaging::LocatingRequest& request);

/// The options of a request that say which part of the stack is searched and how, as words of a shell, each
/// after a space, without --min-explained; empty: none differs from its default.
std::string command_words(const imaging::LocatingRequest& request);

/// The options of a request that say what the discs are: diameter, polarity, refiner.
std::string command_words_of_discs(const imaging::LocatingRequest& request);

/// Opens the stack with the request's frames, flat field and background (prepare_frames), and prints its
/// notes.
std::unique_ptr<imaging::FrameSource> open_for_locating(const std::string& stack,
                                                        const imaging::LocatingRequest& request,
                                                        const imaging::LocatorOptions& locator,
                                                        const Common& common);

}  // namespace twincell::cli

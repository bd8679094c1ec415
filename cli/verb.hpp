#pragma once
/// \file
/// The verbs. Each verb has its own file NAME.cpp with its options struct, its set-up function `add_NAME` (an
/// AddVerb) and the function that it runs. To add a verb, write that file and add its word to the list in
/// main.cpp.

namespace CLI {
class App;
}

namespace twincell::cli {

struct Common;

/// Adds a verb to `program`. The callback of the verb runs if the user selects the verb. It throws
/// twincell::Error on failure.
using AddVerb = void (*)(CLI::App& program, Common& common);

}  // namespace twincell::cli

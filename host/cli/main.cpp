// The command line: finds the command, runs it, turns each kind of failure into one message and one exit code.
#include <signal.h>

#include <algorithm>
#include <iostream>

#include "cli/commands.hpp"
#include "render/renderer.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

std::vector<Command> all_commands() {
  std::vector<Command> commands{render_command(),   batch_command(),   check_command(),      scenes_command(),
                                new_command(),      profile_command(), refraction_command(), trace_command(),
                                transfer_command(), develop_command(), sunset_command(),     eye_command(),
                                compare_command(),  devices_command(), bench_command()};
  std::vector<CommandSpec> specs;
  for (const Command &command : commands) specs.push_back(command.spec);
  commands.push_back(manual_command(specs));
  return commands;
}

std::string overview(const std::vector<Command> &commands) {
  std::string text = std::string("greenray ") + version() + ": light along curved paths through air\n\n";
  for (const Command &c : commands) {
    std::string left = "  greenray " + c.spec.name + " " + c.spec.positional;
    left.resize(std::max<std::size_t>(left.size() + 2, 34), ' ');
    text += left + c.spec.summary + "\n";
  }
  return text + "\n`greenray COMMAND --help` lists the flags of one.\n";
}

int dispatch(const std::vector<std::string> &words) {
  const std::vector<Command> commands = all_commands();
  if (words.empty() || words[0] == "--help" || words[0] == "-h" || (words[0] == "help" && words.size() == 1)) {
    std::cout << overview(commands);
    return 0;
  }
  if (words[0] == "--version") {
    std::cout << "greenray " << version() << "\n";
    return 0;
  }
  const bool help = words[0] == "help";
  const std::string name = help ? words[1] : words[0];
  const auto found =
      std::find_if(commands.begin(), commands.end(), [&](const Command &c) { return c.spec.name == name; });
  if (found == commands.end()) {
    std::vector<std::string> names;
    for (const Command &c : commands) names.push_back(c.spec.name);
    throw InputError({"command line", 1, help ? 15 : 10},
                     "unknown command '" + name + "'" + did_you_mean(name, names) + "; `greenray --help` lists them");
  }
  const Arguments arguments(found->spec, help ? std::vector<std::string>{"--help"}
                                              : std::vector<std::string>(words.begin() + 1, words.end()));
  if (arguments.wants_help()) {
    std::cout << usage(found->spec);
    return 0;
  }
  return found->run(arguments);
}

}  // namespace
}  // namespace greenray::cli

/// The first interrupt asks the work to stop between batches, with nothing half-written; a second one kills as usual.
static void install_signal_handlers() {
  struct sigaction stop {};
  stop.sa_handler = [](int) { greenray::request_stop(); };
  stop.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &stop, nullptr);
  sigaction(SIGTERM, &stop, nullptr);
  signal(SIGXFSZ, SIG_IGN);  // a file-size limit then shows as a failed write
  signal(SIGPIPE, SIG_IGN);
}

int main(int count, char **words) {
  install_signal_handlers();
  try {
    const int code = greenray::cli::dispatch({words + 1, words + count});
    if (!std::cout.flush()) throw greenray::RunError("cannot write to standard output");
    return code;
  } catch (const greenray::InputError &error) {
    std::cerr << error.what() << "\n";
    return static_cast<int>(error.exit_code());
  } catch (const greenray::Error &error) {
    std::cerr << "greenray: " << error.what() << "\n";
    return static_cast<int>(error.exit_code());
  } catch (const std::bad_alloc &) {
    std::cerr << "greenray: out of memory on the host: try a smaller --size, fewer rows or wavelengths\n";
    return static_cast<int>(greenray::ExitCode::out_of_memory);
  } catch (const std::exception &error) {
    std::cerr << "greenray: " << error.what() << "\n";
    return static_cast<int>(greenray::ExitCode::run_failed);
  }
}

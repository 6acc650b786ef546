// greenray manual: the man page and what shells complete, both made from the commands' own specifications.
#include <algorithm>
#include <iostream>
#include <sstream>

#include "cli/commands.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

using Specs = std::vector<CommandSpec>;

/// Text for a line of a man page: no hyphenated minus, no line that begins like a request.
std::string roff(const std::string &text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') out += "\\e";
    else if (c == '-') out += "\\-";
    else if (c == '\'') out += "\\(aq";
    else out += c;
  }
  return !out.empty() && out[0] == '.' ? "\\&" + out : out;
}

std::string flag_words(const Flag &flag) {
  std::string words =
      (flag.short_name.empty() ? "" : "\\fB" + roff(flag.short_name) + "\\fR, ") + "\\fB" + roff(flag.name) + "\\fR";
  return flag.value.empty() ? words : words + " \\fI" + roff(flag.value) + "\\fR";
}

bool is_common(const Flag &flag) {
  const std::vector<Flag> common = common_flags();
  return std::any_of(common.begin(), common.end(),
                     [&](const Flag &c) { return c.name == flag.name && c.help == flag.help; });
}

void add_flag(std::ostream &out, const Flag &flag) {
  out << ".TP\n" << flag_words(flag) << "\n" << roff(flag.help) << (flag.required ? " (required)" : "") << "\n";
}

const char *const page_end =
    ".SH EXIT STATUS\n"
    ".TP\n0\ndone\n.TP\n1\nthe run failed\n.TP\n2\nthe input is wrong: FILE:LINE:COLUMN and what was expected\n"
    ".TP\n3\nno device: install an OpenCL driver, such as pocl\\-opencl\\-icd\n.TP\n4\nout of memory\n"
    ".TP\n5\nstopped early, with what was done written or kept in a checkpoint\n"
    ".TP\n6\npictures or speeds differ by more than allowed\n"
    ".TP\n130\ninterrupted; a picture that keeps checkpoints goes on from there the next time\n"
    ".SH ENVIRONMENT\n"
    ".TP\n\\fBGREENRAY_DEVICE\\fR\nwhat \\fB\\-\\-device\\fR takes, for all commands\n"
    ".TP\n\\fBPOCL_CACHE_DIR\\fR\nwhere PoCL keeps compiled kernels\n"
    ".SH EXAMPLES\n"
    ".EX\ngreenray render flat\\-sun \\-o sun.exr\n"
    "greenray refraction us76 \\-\\-height 2 \\-\\-altitudes 0:10:1 \\-\\-wavelengths 450,550,650\n"
    "greenray develop sun.exr \\-\\-observer human \\-o eye.png\n.EE\n"
    ".SH SEE ALSO\nGutierrez, Seron, Anson and Munoz, \\(lqChasing the Green Flash: a Global Illumination Solution for "
    "Inhomogeneous Media\\(rq (2004), where it started.\n";

std::string man_page(const Specs &specs) {
  std::ostringstream out;
  out << ".TH GREENRAY 1 \"\" \"greenray " << roff(version()) << "\" \"User Commands\"\n"
      << ".SH NAME\ngreenray \\- light along curved paths through air\n"
      << ".SH SYNOPSIS\n.B greenray\n.I COMMAND\n[\\fIflags\\fR]\n"
      << ".SH DESCRIPTION\nSends light along the curved paths it takes through air whose refractive index changes from "
         "place to place, on any OpenCL device, and shows what an eye would see: mirages, flattened and split suns, "
         "the green flash, and rooms lit through bent light.\n"
      << ".SH COMMANDS\n";
  for (const CommandSpec &spec : specs) {
    out << ".SS greenray " << roff(spec.name) << (spec.positional.empty() ? "" : " " + roff(spec.positional)) << "\n"
        << roff(spec.summary) << "\n";
    for (const Flag &flag : spec.flags)
      if (!is_common(flag)) add_flag(out, flag);
  }
  out << ".SH FLAGS OF MOST COMMANDS\n";
  for (const Flag &flag : common_flags()) add_flag(out, flag);
  return out.str() + page_end;
}

/// "on|off", "a | b (default) | c" in a flag's value or help -> the words; nothing for a value of its own.
std::string choices(const Flag &flag) {
  const std::string &text = flag.value.find('|') != std::string::npos ? flag.value : flag.help;
  if (flag.value.empty() || text.find('|') == std::string::npos) return "";
  std::string list, word;
  const auto add = [&] {
    if (!word.empty() && std::all_of(word.begin(), word.end(),
                                     [](unsigned char c) { return std::islower(c) || std::isdigit(c) || c == '-'; }))
      list += (list.empty() ? "" : " ") + word;
    word.clear();
  };
  bool ended = false;  // what stands behind a word explains it
  for (const char c : text) {
    if (c == ':' || c == ';') break;
    if (c == '|') add(), ended = false;
    else if (c == ' ') ended = ended || !word.empty();
    else if (!ended) word += c;
  }
  add();
  return list;
}

std::string words_of(const Specs &specs) {
  std::string words;
  for (const CommandSpec &spec : specs) words += (words.empty() ? "" : " ") + spec.name;
  return words;
}

/// A scene or a profile may be named by its shipped name.
bool wants_scene(const CommandSpec &spec) { return spec.positional.find("SCENE") != std::string::npos; }

std::string bash_completion(const Specs &specs) {
  std::ostringstream out;
  out << "# bash completion for greenray " << version() << ", made by `greenray manual bash`\n"
      << "_greenray() {\n"
      << "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} flags='' values='' names=''\n"
      << "  COMPREPLY=()\n"
      << "  if ((COMP_CWORD == 1)); then\n    COMPREPLY=($(compgen -W '" << words_of(specs)
      << " help --help --version' -- \"$word\"))\n    return\n  fi\n  case ${COMP_WORDS[1]} in\n";
  for (const CommandSpec &spec : specs) {
    out << "    " << spec.name << ")\n      flags='";
    for (const Flag &flag : spec.flags) out << (&flag == &spec.flags[0] ? "" : " ") << flag.name;
    out << "'\n";
    if (wants_scene(spec)) out << "      names=$(\"${COMP_WORDS[0]}\" scenes 2>/dev/null | cut -d' ' -f1)\n";
    out << "      case $before in\n";
    for (const Flag &flag : spec.flags)
      if (!flag.value.empty())
        out << "        " << flag.name << (flag.short_name.empty() ? "" : "|" + flag.short_name) << ") values='"
            << choices(flag) << "' flags='' names='' ;;\n";
    out << "      esac ;;\n";
  }
  out << "    help) names='" << words_of(specs) << "' ;;\n  esac\n"
      << "  if [[ $word == -* ]]; then COMPREPLY=($(compgen -W \"$flags\" -- \"$word\"))\n"
      << "  else COMPREPLY=($(compgen -W \"$values $names\" -- \"$word\")); fi\n"
      << "}\ncomplete -o default -F _greenray greenray\n";
  return out.str();
}

std::string fish_completion(const Specs &specs) {
  const auto quoted = [](const std::string &text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return out + "'";
  };
  std::ostringstream out;
  out << "# fish completion for greenray " << version() << ", made by `greenray manual fish`\n";
  for (const CommandSpec &spec : specs) {
    out << "complete -c greenray -n __fish_use_subcommand -f -a " << spec.name << " -d " << quoted(spec.summary)
        << "\n";
    const std::string when = "complete -c greenray -n '__fish_seen_subcommand_from " + spec.name + "'";
    if (wants_scene(spec)) out << when << " -a '(greenray scenes 2>/dev/null | string replace -r \" .*\" \"\")'\n";
    for (const Flag &flag : spec.flags) {
      out << when << " -l " << flag.name.substr(2);
      if (!flag.short_name.empty()) out << " -s " << flag.short_name.substr(1);
      if (!flag.value.empty()) out << " -r";
      if (const std::string list = choices(flag); !list.empty()) out << " -f -a " << quoted(list);
      out << " -d " << quoted(flag.help) << "\n";
    }
  }
  return out.str();
}

}  // namespace

Command manual_command(std::vector<CommandSpec> specs) {
  const CommandSpec own{"manual",
                        "[KIND]",
                        "This manual as a man page (roff), or completion for a shell: man | bash | fish.",
                        {{"--output", "-o", "FILE", "where to write (standard output)"}, common_flags().back()}};
  specs.push_back(own);
  return {own, [specs](const Arguments &arguments) {
            const std::string kind = arguments.positional().empty() ? "man" : arguments.positional()[0];
            if (kind == "man") emit(arguments, man_page(specs));
            else if (kind == "bash") emit(arguments, bash_completion(specs));
            else if (kind == "fish") emit(arguments, fish_completion(specs));
            else throw InputError(arguments.positional_place(0), "expected man | bash | fish, found '" + kind + "'");
            return 0;
          }};
}

}  // namespace greenray::cli

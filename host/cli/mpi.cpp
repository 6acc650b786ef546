#include "cli/mpi.hpp"

#include <dlfcn.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "mpi/greenray_mpi.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

namespace fs = std::filesystem;

OneRank alone;
Ranks *joined = nullptr;
decltype(&greenray_mpi_finish) finish = nullptr;
decltype(&greenray_mpi_abort) abort_all = nullptr;

int number_from(const char *variable, int otherwise) {
  const char *text = std::getenv(variable);
  return text && *text ? std::atoi(text) : otherwise;
}

/// Beside the tool, or in the library folder of the same installation.
void *open_module(std::string &reason) {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  const char *const name = "libgreenray-mpi.so";
  for (const fs::path &file : {folder / name, folder / ".." / GREENRAY_MODULE_FOLDER / name}) {
    if (!fs::exists(file, error)) continue;
    if (void *module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL)) return module;
    reason = ::dlerror();
  }
  return nullptr;
}

[[noreturn]] void cannot_join(const std::string &reason) {
  throw InputError({"command line", 1, 1},
                   "mpirun started this greenray and it cannot join the others" +
                       (reason.empty() ? "" : " (" + reason + ")") +
                       ": expected libgreenray-mpi.so beside it, as it is built where libopenmpi-dev is installed; "
                       "--shard I/N needs no MPI");
}

template <class F>
F *symbol(void *module, const char *name) {
  void *found = ::dlsym(module, name);
  if (!found) cannot_join(std::string("no ") + name);
  return reinterpret_cast<F *>(found);
}

/// mpirun binds each process to a core unless told otherwise: then a device of several cores has one.
void note_a_binding() {
  cpu_set_t mine;
  if (sched_getaffinity(0, sizeof mine, &mine) != 0) return;
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  if (CPU_COUNT(&mine) < cores && joined->first())
    std::cerr << "note: mpirun lets each worker use " << CPU_COUNT(&mine) << " of " << cores
              << " processors; --bind-to none lets it use all\n";
}

}  // namespace

Ranks &all_workers() { return joined ? *joined : alone; }

int worker_on_this_machine() { return joined ? number_from("OMPI_COMM_WORLD_LOCAL_RANK", 0) : 0; }

void join_workers(const std::string &command) {
  if (number_from("OMPI_COMM_WORLD_SIZE", 1) <= 1) return;
  if (command == "batch" || command == "merge")
    throw InputError({"command line", 1, 1}, "greenray " + command +
                                                 " does not work with others under mpirun: expected `greenray render`, "
                                                 "or `greenray batch --shard I/N` on each machine");
  if (command != "render") return;
  std::string reason;
  void *module = open_module(reason);
  if (!module) cannot_join(reason);
  if (symbol<const char *()>(module, "greenray_mpi_version")() != std::string(version()))
    cannot_join("it is of another version");
  finish = symbol<void()>(module, "greenray_mpi_finish");
  abort_all = symbol<void(int)>(module, "greenray_mpi_abort");
  joined = symbol<Ranks *()>(module, "greenray_mpi_start")();
  if (!joined) cannot_join("MPI does not start");
  note_a_binding();
}

void leave_workers(int code) {
  if (!joined) return;
  if (code != 0 && !joined->parted()) abort_all(code);
  finish();
}

}  // namespace greenray::cli

// mpirun -n N greenray render: joins the other processes.
#pragma once
#include "support/ranks.hpp"

namespace greenray::cli {

/// The workers that mpirun started, this one among them; one alone where it did not, and for other commands.
Ranks &all_workers();

/// Among the workers of this machine; 0 without mpirun.
int worker_on_this_machine();

/* Runs a command as one of several workers where mpirun started it, else by itself. Worker 0 does the talking.
   errors: InputError when mpirun started it and it cannot join */
class Workers {
 public:
  explicit Workers(const std::string &command);
  ~Workers();
  Workers(const Workers &) = delete;
  Workers &operator=(const Workers &) = delete;
  /// After the last word was said. Does not return where the others do not know that it is over.
  void leave(int code);
};

}  // namespace greenray::cli

// mpirun -n N greenray render: joins the other processes.
#pragma once
#include "support/ranks.hpp"

namespace greenray::cli {

/// The workers that mpirun started, this one among them; one alone where it did not, and for other commands.
Ranks &all_workers();

/// Among the workers of this machine; 0 without mpirun.
int worker_on_this_machine();

/// Where mpirun started this process and `command` is render, joins the others. errors: InputError when it cannot
void join_workers(const std::string &command);
/// After the last word was said. Does not return where the others do not know that it is over and code is not 0.
void leave_workers(int code);

}  // namespace greenray::cli

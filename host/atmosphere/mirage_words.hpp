// The sentences of a diagnosis. A part of diagnosis.cpp: others call diagnose().
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "atmosphere/diagnosis.hpp"

namespace greenray {

/// What an eye at this height, or anyone, will see of the layers already found; never empty.
std::vector<std::string> mirages_to_expect(const Profile &profile, const Diagnosis &found,
                                           std::optional<double> eye_height_m);

}  // namespace greenray

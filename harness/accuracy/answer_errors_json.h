// SPDX-License-Identifier: MIT
#pragma once

#include "harness/accuracy/answer_errors.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// Errors as they are kept and sent from process to process, every number exactly; no part of a record.
void to_json(nlohmann::json& to, const AnswerErrors& errors);
void from_json(const nlohmann::json& from, AnswerErrors& errors);

} // namespace tandem

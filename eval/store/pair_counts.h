#pragma once

struct sqlite3;

namespace moma::store {

/// Adds the table pair_counts to a connection to a store: v_pairs counted per family, one row for each pair of points
/// of one suite, robot and mode that share a world, with columns suite, family, mode, controller_a, point_a,
/// controller_b, point_b, n, both, only_a, only_b, neither. The same as
///   SELECT ..., count(*), sum(success_a AND success_b), ... FROM v_pairs GROUP BY ...
/// but counted with one bit per trial: one pass over point_trial, then points^2 * worlds / 64 operations, where SQL
/// would go through points^2 * worlds rows. Throws SQLite::Exception.
void add_pair_counts(sqlite3* connection);

}  // namespace moma::store

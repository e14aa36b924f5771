#include "eval/store/tuning.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "controller/config/json_text.h"
#include "controller/config/text_file.h"
#include "eval/search/words.h"
#include "eval/store/database.h"
#include "eval/store/hash.h"
#include "eval/store/machine.h"
#include "eval/store/row_binding.h"
#include "eval/store/words.h"

namespace moma::store {
namespace {

using nlohmann::json;
using SQLite::Statement;
using tune::SearchStatus;

// Little endian whatever the machine, so that a store can be carried anywhere.
std::vector<unsigned char> to_bytes(const std::vector<double>& values) {
  std::vector<unsigned char> bytes;
  bytes.reserve(values.size() * 8);
  for (const double value : values) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<unsigned char>(bits >> shift));
  }
  return bytes;
}

/// A list of numbers as append() writes it; a store may hold anything.
std::vector<double> numbers_of(const std::string& text, std::uint64_t evaluation) {
  const std::string source = fmt::format("evaluation {} of the search", evaluation);
  try {
    return config::parse_json(text, source).get<std::vector<double>>();
  } catch (const json::exception&) {
    throw StoreError(StoreError::Kind::kUnusable,
                     fmt::format("{}: '{}' is no list of numbers", source, config::shortened(text)));
  }
}

std::vector<double> from_bytes(const unsigned char* bytes, std::size_t count) {
  std::vector<double> values(count / 8);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint64_t bits = 0;
    for (std::size_t b = 0; b < 8; ++b) bits |= static_cast<std::uint64_t>(bytes[8 * i + b]) << (8 * b);
    values[i] = std::bit_cast<double>(bits);
  }
  return values;
}

template <typename T>
void bind_optional(Statement& s, int index, const std::optional<T>& value) {
  if (value) {
    s.bind(index, *value);
  } else {
    s.bind(index);
  }
}

template <typename Work>
auto write(Writer& writer, const Work& work) {
  try {
    writer.flush();  // what a record is made of is there before it
    SQLite::Database& db = writer.database();
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    work(db);
    transaction.commit();
  } catch (const SQLite::Exception& error) {
    throw explain(error, writer.database().getFilename(), StoreError::Kind::kInterrupted);
  }
}

std::string word(tune::SearchStatus status) { return std::string(to_string(status)); }

void insert_variables(SQLite::Database& db, std::int64_t id, const TuneSearchRecord& search) {
  Statement s(db,
              "INSERT INTO tune_variable (search_id, variable, key, lower, upper, scale, start) "
              "VALUES (?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < search.variables.size(); ++i) {
    const TuneVariableRecord& v = search.variables[i];
    s.reset();
    s.bind(1, id);
    s.bind(2, static_cast<int>(i));
    s.bind(3, v.key);
    s.bind(4, v.lower);
    s.bind(5, v.upper);
    s.bind(6, v.scale);
    s.bind(7, v.start);
    s.exec();
  }
}

void clear(SQLite::Database& db, const char* table, std::int64_t id) {
  Statement s(db, std::string("DELETE FROM ") + table + " WHERE search_id = ?");
  s.bind(1, id);
  s.exec();
}

}  // namespace

TuneRecords::TuneRecords(Writer& writer, const TuneSearchRecord& search) : writer_(writer) {
  write(writer, [&](SQLite::Database& db) {
    const Hash hash = hash_text(search.identity);
    Statement find(db, "SELECT id FROM tune_search WHERE hash = ?");
    find.bind(1, hash.data(), static_cast<int>(hash.size()));
    if (find.executeStep()) {
      id_ = find.getColumn(0).getInt64();
      Statement again(db, "UPDATE tune_search SET status = ?, ended = NULL WHERE id = ?");
      again.bind(1, word(SearchStatus::kRunning));
      again.bind(2, id_);
      again.exec();
    } else {
      Statement s(
          db,
          "INSERT INTO tune_search (hash, suite, controller, identity, objective, unit, budget_trials, started, "
          "status) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
      s.bind(1, hash.data(), static_cast<int>(hash.size()));
      s.bind(2, search.suite);
      s.bind(3, search.controller);
      s.bind(4, search.identity);
      s.bind(5, search.objective);
      s.bind(6, search.unit);
      s.bind(7, static_cast<std::int64_t>(search.budget_trials));
      s.bind(8, utc_now());
      s.bind(9, word(SearchStatus::kRunning));
      s.exec();
      id_ = db.getLastInsertRowid();
      insert_variables(db, id_, search);
    }
    Statement count(db, "SELECT count(*) FROM tune_evaluation WHERE search_id = ?");
    count.bind(1, id_);
    count.executeStep();
    present_ = static_cast<std::uint64_t>(count.getColumn(0).getInt64());
  });
}

std::optional<TuneEvaluationRecord> TuneRecords::find(std::uint64_t evaluation) {
  if (evaluation >= present_) return std::nullopt;  // nothing beyond was stored before this run
  try {
    Statement s(writer_.database(),
                "SELECT phase, run, candidate, first_world, worlds, cut, valid, cost, merit, "
                "constraints, measured FROM tune_evaluation WHERE search_id = ? AND evaluation = ?");
    s.bind(1, id_);
    s.bind(2, static_cast<std::int64_t>(evaluation));
    if (!s.executeStep()) return std::nullopt;
    TuneEvaluationRecord r;
    r.evaluation = evaluation;
    r.phase = s.getColumn(0).getString();
    r.run = s.getColumn(1).getInt();
    r.candidate = numbers_of(s.getColumn(2).getString(), evaluation);
    r.first_world = static_cast<std::uint64_t>(s.getColumn(3).getInt64());
    r.worlds = static_cast<std::uint64_t>(s.getColumn(4).getInt64());
    r.cut = s.getColumn(5).getInt() != 0;
    r.valid = s.getColumn(6).getInt() != 0;
    r.cost = s.getColumn(7).getDouble();
    r.merit = s.getColumn(8).getDouble();
    r.constraints = numbers_of(s.getColumn(9).getString(), evaluation);
    const SQLite::Column measured = s.getColumn(10);
    r.measured = from_bytes(static_cast<const unsigned char*>(measured.getBlob()),
                            static_cast<std::size_t>(measured.getBytes()));
    return r;
  } catch (const SQLite::Exception& error) {
    throw explain(error, writer_.database().getFilename(), StoreError::Kind::kInterrupted);
  }
}

void TuneRecords::append(const TuneEvaluationRecord& r) {
  write(writer_, [&](SQLite::Database& db) {
    Statement s(db,
                "INSERT INTO tune_evaluation (search_id, evaluation, phase, run, candidate, first_world, worlds, cut, "
                "valid, cost, merit, constraints, measured) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    int i = 0;
    s.bind(++i, id_);
    s.bind(++i, static_cast<std::int64_t>(r.evaluation));
    s.bind(++i, r.phase);
    s.bind(++i, r.run);
    s.bind(++i, json(r.candidate).dump());
    s.bind(++i, static_cast<std::int64_t>(r.first_world));
    s.bind(++i, static_cast<std::int64_t>(r.worlds));
    s.bind(++i, r.cut ? 1 : 0);
    s.bind(++i, r.valid ? 1 : 0);
    s.bind(++i, r.cost);
    s.bind(++i, r.merit);
    s.bind(++i, json(r.constraints).dump());
    const std::vector<unsigned char> bytes = to_bytes(r.measured);
    s.bind(++i, bytes.empty() ? "" : static_cast<const void*>(bytes.data()), static_cast<int>(bytes.size()));
    s.exec();
  });
}

void TuneRecords::stopped() {
  write(writer_, [&](SQLite::Database& db) {
    Statement s(db, "UPDATE tune_search SET ended = ?, status = ? WHERE id = ?");
    s.bind(1, utc_now());
    s.bind(2, word(SearchStatus::kStopped));
    s.bind(3, id_);
    s.exec();
  });
}

void TuneRecords::finish(const TuneResultRecord& result) {
  write(writer_, [&](SQLite::Database& db) {
    Statement search(db,
                     "UPDATE tune_search SET ended = ?, trials = ?, trials_saved = ?, "
                     "evaluations_cut = ?, runs = ?, notes = ?, status = ? WHERE id = ?");
    search.bind(1, utc_now());
    search.bind(2, static_cast<std::int64_t>(result.trials));
    search.bind(3, static_cast<std::int64_t>(result.trials_saved));
    search.bind(4, static_cast<std::int64_t>(result.evaluations_cut));
    search.bind(5, result.runs);
    search.bind(6, result.notes);
    search.bind(7, word(SearchStatus::kFinished));
    search.bind(8, id_);
    search.exec();
    Statement variable(db, "UPDATE tune_variable SET found = ?, importance = ? WHERE search_id = ? AND variable = ?");
    for (std::size_t i = 0; i < result.found.size(); ++i) {
      variable.reset();
      variable.bind(1, result.found[i]);
      bind_number(variable, 2, result.importance[i]);
      variable.bind(3, id_);
      variable.bind(4, static_cast<int>(i));
      variable.exec();
    }
    clear(db, "tune_finalist", id_);
    Statement finalist(
        db,
        "INSERT INTO tune_finalist (search_id, place, candidate, search_merit, merit, neighbours, robust, "
        "worlds) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    for (std::size_t i = 0; i < result.finalists.size(); ++i) {
      const TuneFinalistRecord& f = result.finalists[i];
      finalist.reset();
      finalist.bind(1, id_);
      finalist.bind(2, static_cast<int>(i));
      finalist.bind(3, json(f.candidate).dump());
      finalist.bind(4, f.search_merit);
      finalist.bind(5, f.merit);
      finalist.bind(6, f.neighbours);
      finalist.bind(7, f.robust);
      finalist.bind(8, static_cast<std::int64_t>(f.worlds));
      finalist.exec();
    }
    clear(db, "tune_sensitivity", id_);
    Statement sensitivity(
        db,
        "INSERT INTO tune_sensitivity (search_id, entry, variable, other, value, change, error, valid) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    for (std::size_t i = 0; i < result.sensitivity.size(); ++i) {
      const TuneSensitivityRecord& r = result.sensitivity[i];
      sensitivity.reset();
      sensitivity.bind(1, id_);
      sensitivity.bind(2, static_cast<int>(i));
      sensitivity.bind(3, r.variable);
      bind_optional(sensitivity, 4, r.other);
      bind_optional(sensitivity, 5, r.value);
      sensitivity.bind(6, r.change);
      sensitivity.bind(7, r.error);
      sensitivity.bind(8, r.valid ? 1 : 0);
      sensitivity.exec();
    }
  });
}

void TuneRecords::verdict(const std::string& held_out_suite, const std::vector<TuneComparisonRecord>& rows,
                          const std::string& overall) {
  write(writer_, [&](SQLite::Database& db) {
    Statement search(db, "UPDATE tune_search SET held_out_suite = ?, verdict = ? WHERE id = ?");
    search.bind(1, held_out_suite);
    search.bind(2, overall);
    search.bind(3, id_);
    search.exec();
    clear(db, "tune_comparison", id_);
    Statement s(
        db,
        "INSERT INTO tune_comparison (search_id, entry, family, other, metric, n, found, found_low, found_high, "
        "theirs, theirs_low, theirs_high, difference, difference_low, difference_high, p, verdict) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const TuneComparisonRecord& r = rows[k];
      s.reset();
      int i = 0;
      s.bind(++i, id_);
      s.bind(++i, static_cast<int>(k));
      s.bind(++i, r.family);
      s.bind(++i, r.other);
      s.bind(++i, r.metric);
      s.bind(++i, r.n);
      for (const double value : {r.found, r.found_low, r.found_high, r.theirs, r.theirs_low, r.theirs_high,
                                 r.difference, r.difference_low, r.difference_high, r.p}) {
        bind_number(s, ++i, value);
      }
      s.bind(++i, r.verdict);
      s.exec();
    }
  });
}

}  // namespace moma::store

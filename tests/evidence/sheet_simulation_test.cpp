// SPDX-License-Identifier: GPL-3.0-or-later
// Simulations that another computer makes from a recipe: the same bits, or the same sentence why there is none.
#include "evidence/models/thermoform/sheet_simulation.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <string>

#include "base/error.h"
#include "evidence/fit/simulation_bag.h"
#include "evidence/models/thermoform/thermoform_model.h"
#include "evidence/virtual_lab.h"

namespace formwright {
namespace {

using Catch::Matchers::ContainsSubstring;
using namespace virtual_lab;

FormedObject quick_object() {
  std::mt19937 random(3);
  HiddenWorld world;
  world.triangles = 1500;
  Observation observation;
  observation.points = 60;
  observation.sigma_mm = 0.05;
  return make_object(Mould::pyramid, world, {}, observation, random);
}

SheetSimulation quick_simulation(const FormedObject& object) {
  SheetSimulation simulation{object.key, object.setup.base_plate_end_z_mm,
                             read_parameters<ThermoformOptions>(object.setup.parameters)};
  simulation.options.triangles = 500;
  simulation.options.frames = 2;
  return simulation;
}

/// Keeps results in memory; a helper makes them as another computer would, if there is one.
struct KeepingHost {
  std::map<std::string, Bytes> kept;
  int made_here = 0, made_by_helper = 0;
  bool helper_gives_up = false;
  Host host(bool with_helper) {
    Host host;
    host.find_result = [this](const std::string& key) {
      const auto found = kept.find(key);
      return found == kept.end() ? std::nullopt : std::optional<Bytes>(found->second);
    };
    host.keep_result = [this](const std::string& key, const Bytes& bytes) {
      static std::mutex mutex;
      const std::scoped_lock lock(mutex);
      kept[key] = bytes;
      ++made_here;
    };
    if (with_helper)
      host.make_results = [this](const std::vector<ResultTask>& tasks, const std::function<void(double)>& made_share) {
        for (const ResultTask& task : tasks) {
          if (helper_gives_up && made_by_helper > 0) return;
          kept[task.key] = simulated_by_recipe(task.key, Json::parse(task.recipe), *task.input, Context());
          made_share(++made_by_helper / static_cast<double>(tasks.size()));
        }
      };
    return host;
  }
};

TEST_CASE("SheetSimulation.ABatchOfAHelperHasTheSameBits") {
  ThermoformModelOptions options;
  options.triangles = 500;
  const FormedObject object = quick_object();
  const auto run = [&](KeepingHost& keeping, bool with_helper) {
    const ThermoformModel model({object}, options);
    std::vector<Eigen::VectorXd> points(3, model.nominal());
    points[1][0] = 0.2;
    points[2][1] = -0.1;
    Context context(keeping.host(with_helper));
    SimulationBag bag(model);
    return bag.run(points, context, "Simulating");
  };
  KeepingHost alone, helped, left;
  left.helper_gives_up = true;
  const auto expected = run(alone, false), by_helper = run(helped, true), by_both = run(left, true);
  CHECK(alone.made_here == 3);
  CHECK(helped.made_here == 0);
  CHECK(helped.made_by_helper == 3);
  CHECK(left.made_by_helper == 1);
  CHECK(left.made_here == 2);
  CHECK(alone.kept == helped.kept);
  CHECK(alone.kept == left.kept);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    REQUIRE(by_helper[i]);
    CHECK(by_helper[i]->front() == expected[i]->front());
    CHECK(by_both[i]->front() == expected[i]->front());
  }
}

TEST_CASE("SheetSimulation.NoAnswerIsKeptAndTravels") {
  const FormedObject object = quick_object();
  SheetSimulation simulation = quick_simulation(object);
  simulation.options.clamp_opening_x_mm = simulation.options.sheet_x_mm + 10;
  const Bytes here = simulated(simulation, object.mould, Context());
  const Bytes there =
      simulated_by_recipe(simulation.key(), simulation_recipe(simulation), packed_mould(object.mould->mesh), Context());
  CHECK(here == there);
  try {
    kept_sheet(here, simulation.options);
    FAIL_CHECK("there is a sheet");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK_THAT(error.what(), ContainsSubstring("opening"));
  }
}

TEST_CASE("SheetSimulation.DamagedResultsAreNotThere") {
  const FormedObject object = quick_object();
  const SheetSimulation simulation = quick_simulation(object);
  Bytes bytes = simulated(simulation, object.mould, Context());
  REQUIRE(kept_sheet(bytes, simulation.options));
  bytes.pop_back();
  CHECK_FALSE(kept_sheet(bytes, simulation.options));
  CHECK_FALSE(kept_sheet({}, simulation.options));
  for (const char* text : {"no answer:", "no answer:{}", "no answer:[1]", "no answer:{\"unsolvable\": 3}"}) {
    CAPTURE(text);
    CHECK_FALSE(kept_sheet(to_bytes(text), simulation.options));
  }
}

TEST_CASE("SheetSimulation.WrongRecipesAreRefused") {
  const FormedObject object = quick_object();
  const SheetSimulation simulation = quick_simulation(object);
  const Json recipe = simulation_recipe(simulation);
  const Bytes mould = packed_mould(object.mould->mesh);
  const auto make = [&](const Json& changed, const Bytes& mesh) {
    return simulated_by_recipe(simulation.key(), changed, mesh, Context());
  };
  Json other = recipe;
  other["options"]["vacuum_kpa"] = 12.0;
  CHECK_THROWS_WITH(make(other, mould), ContainsSubstring("another result than it is named for"));
  other = recipe;
  other["options"]["unknown_to_this_version"] = 1;
  CHECK_THROWS_WITH(make(other, mould), ContainsSubstring("same version"));
  CHECK_THROWS_WITH(make(Json::array(), mould), ContainsSubstring("cannot be read"));
  Bytes shorter = mould;
  shorter.pop_back();
  CHECK_THROWS_WITH(make(recipe, shorter), ContainsSubstring("another size"));
  CHECK_THROWS_WITH(make(recipe, {}), ContainsSubstring("cut short"));
  Bytes wild = mould;
  for (std::size_t i = wild.size() - sizeof(int); i < wild.size(); ++i) wild[i] = std::byte{0x7f};
  CHECK_THROWS_WITH(make(recipe, wild), ContainsSubstring("no mesh"));
}

}  // namespace
}  // namespace formwright

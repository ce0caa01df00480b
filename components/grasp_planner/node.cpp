#include "components/grasp_planner/node.hpp"

#include <algorithm>

#include "common/config/resources.hpp"
#include "common/model/platform.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr std::size_t kRememberedReplies = 8;
constexpr std::size_t kMaxPending = 16;  // requests of a kind that wait; one is worked on for up to some seconds
constexpr const char* kFull = "16 requests wait already, which is the limit; ask again later";
constexpr std::uint32_t kTakerPositions = 40, kTakerOrientations = 72;
constexpr double kMoved = 0.01;  // [m] an object moved by more needs new candidates

config::GraspPlannerSettings load_settings(const NodeContext& context) {
  config::GraspPlannerSettings settings;
  load_text_proto(context.settings / "grasp_planner.txtpb", settings);
  return settings;
}

std::shared_ptr<const HandKit> load_kit(const NodeContext& context) {
  if (context.robot->hand().empty()) throw ConfigError("robot " + context.robot->name() + " names no hand; the grasp planner needs one");
  return std::make_shared<const HandKit>(HandModel::load(hand_description(context.robot->hand())));
}

std::shared_ptr<const RobotModel> mobile(const NodeContext& context) {
  if (context.description.empty()) return nullptr;
  auto model = on_platform(*context.robot, context.description);
  return model ? std::make_shared<const RobotModel>(std::move(*model)) : nullptr;
}

/// The first with the kit and the book that are there already.
std::vector<ArmBook> load_arms(const NodeContext& context, const std::shared_ptr<const HandKit>& kit,
                               const std::shared_ptr<GraspBook>& book, const GraspListSettings& settings, const GraspStore& store) {
  std::vector<ArmBook> arms;
  if (context.description.empty()) return arms;
  for (const Manipulator& m : manipulators(context.description, *context.robot)) {
    if (arms.empty()) {
      arms.push_back({m, kit, book});
      continue;
    }
    const auto other = std::make_shared<const HandKit>(HandModel::load(hand_description(m.hand)));
    arms.push_back({m, other, std::make_shared<GraspBook>(other, settings, store)});
  }
  return arms;
}

RegraspSettings regrasp_settings(const config::GraspPlannerSettings& text) {
  RegraspSettings s;
  s.lift = text.lift();
  s.stand_off = text.stand_off();
  s.grip = list_settings(text, 1).grip;
  return s;
}

double positive(const char* key, double value) {
  if (!(value > 0)) throw ConfigError(std::string("grasp_planner.txtpb: ") + key + " must be > 0");
  return value;
}

// Modelled time of the work done, from the counts: about what one core needs. A list is read, as it is from an object's second day on.
constexpr Duration kReadList = std::chrono::milliseconds(5);
Duration regrasp_time(const RegraspAnswer& answer) {
  return from_seconds(0.05 + 4e-3 * static_cast<double>(answer.judged) + 2e-4 * static_cast<double>(answer.listed));
}
Duration choice_time(const Choice& choice) {
  return from_seconds(0.002 + 4e-4 * static_cast<double>(choice.reaches) + 5e-5 * static_cast<double>(choice.transfer_reaches) +
                      3e-5 * static_cast<double>(choice.states) + 4e-5 * static_cast<double>(choice.touch_tests));
}

// A person's list is one of several for an object: fewer frames do.
GraspListSettings taker_settings(const config::GraspPlannerSettings& text) {
  GraspListSettings s = list_settings(text, 1);
  s.positions = std::min(s.positions, kTakerPositions);
  s.spacing = 0;
  s.orientations = std::min(s.orientations, kTakerOrientations);
  return s;
}

std::shared_ptr<TransferBook> transfer_book(const config::GraspPlannerSettings& text, const std::shared_ptr<const HandKit>& robot,
                                            const GraspStore& store) {
  if (text.taker().empty()) return nullptr;
  const auto taker = std::make_shared<const HandKit>(HandModel::load(hand_description(text.taker())));
  return std::make_shared<TransferBook>(robot, taker, taker_settings(text), store);
}

}  // namespace

GraspListSettings list_settings(const config::GraspPlannerSettings& t, std::uint64_t seed) {
  GraspListSettings s;
  s.positions = static_cast<std::uint32_t>(positive("positions", t.positions()));
  s.spacing = positive("spacing", t.spacing());
  s.orientations = static_cast<std::uint32_t>(positive("orientations", t.orientations()));
  s.step_share = positive("step_share", t.step_share());
  if (t.cone_edges() < 6) throw ConfigError("grasp_planner.txtpb: cone_edges must be at least 6");
  s.cone_edges = static_cast<int>(t.cone_edges());
  s.full_epsilon = positive("full_epsilon", t.full_epsilon());
  s.weights = {t.weight_stability(), t.weight_centre(), t.weight_force(), t.weight_curvature()};
  if (std::min({t.weight_stability(), t.weight_centre(), t.weight_force(), t.weight_curvature()}) < 0 ||
      !(t.weight_stability() + t.weight_centre() + t.weight_force() + t.weight_curvature() > 0)) {
    throw ConfigError("grasp_planner.txtpb: the weights of the quality must not be negative, and one must be > 0");
  }
  s.contacts_per_finger = static_cast<std::uint32_t>(positive("contacts_per_finger", t.contacts_per_finger()));
  s.tries_per_finger = static_cast<std::uint32_t>(positive("tries_per_finger", t.tries_per_finger()));
  s.opening = positive("opening", t.opening());
  s.open_clearance = positive("open_clearance", t.open_clearance());
  s.free_distance = positive("free_distance", t.free_distance());
  s.grip.max_normal = positive("grip_force", t.grip_force());
  s.grip.friction_share = positive("grip_friction", t.grip_friction());
  if (s.grip.friction_share > 1) throw ConfigError("grasp_planner.txtpb: grip_friction must be at most 1");
  s.grip.acceleration = positive("grip_acceleration", t.grip_acceleration());
  s.seed = seed;
  return s;
}

ChoiceSettings choice_settings(const config::GraspPlannerSettings& t) {
  ChoiceSettings s;
  s.stand_off = positive("stand_off", t.stand_off());
  s.approach_clearance = positive("approach_clearance", t.approach_clearance());
  s.lift = positive("lift", t.lift());
  s.support_gap = positive("support_gap", t.support_gap());
  s.reach_budget = static_cast<std::uint32_t>(positive("reach_budget", t.reach_budget()));
  s.rank_quality = t.rank_quality();
  s.rank_posture = t.rank_posture();
  s.rank_contacts = t.rank_contacts();
  s.rank_room = t.rank_room();
  s.rank_exchange = t.rank_exchange();
  s.rank_partner = t.rank_partner();
  s.rank_transfer = t.rank_transfer();
  s.rank_sturdy = t.rank_sturdy();
  s.sturdy_margin = positive("sturdy_margin", t.sturdy_margin());
  s.rank_visible = t.rank_visible();
  s.rank_tilt = t.rank_tilt();
  s.rank_away = t.rank_away();
  s.rank_stands = t.rank_stands();
  s.off_fingers = positive("off_fingers", t.off_fingers());
  s.off_giver = positive("off_giver", t.off_giver());
  if (s.off_giver < s.off_fingers) throw ConfigError("grasp_planner.txtpb: off_giver must be at least off_fingers");
  s.rank_drive = t.rank_drive();
  s.platform_room = t.platform_room();
  s.platform_reaches = static_cast<std::uint32_t>(positive("platform_reaches", t.platform_reaches()));
  return s;
}

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      settings_(load_settings(context)),
      objects_(context.objects),
      kit_(load_kit(context)),
      chooser_(std::make_shared<const GraspChooser>(context.robot, kit_, context.objects, choice_settings(settings_), mobile(context))),
      // The list of an object is the same whatever the seed of the node: it is kept on disk and shared.
      book_(std::make_shared<GraspBook>(kit_, list_settings(settings_, 1), GraspStore(settings_.store() ? default_store() : ""))),
      transfers_(transfer_book(settings_, kit_, GraspStore(settings_.store() ? default_store() : ""))),
      arms_(load_arms(context, kit_, book_, list_settings(settings_, 1), GraspStore(settings_.store() ? default_store() : ""))),
      regrasp_settings_(regrasp_settings(settings_)),
      reply_out_(bus.advertise<GraspReply>()),
      regrasp_out_(bus.advertise<RegraspReply>()),
      candidates_out_(bus.advertise<GraspCandidates>()) {
  positive("candidates_period", settings_.candidates_period());
  bus.subscribe<Scene>([this](const Scene& scene, const Receipt&) {
    scene_ = scene;
    prepare(scene);
  });
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt&) { people_ = people; });
  bus.subscribe<GraspRequest>([this](const GraspRequest& request, const Receipt&) { answer(request); });
  bus.subscribe<RegraspRequest>([this](const RegraspRequest& request, const Receipt&) { answer(request); });
  bus.every(from_seconds(settings_.candidates_period()), [this](TimePoint now) { propose(now); });
}

void Node::prepare(const Scene& scene) {
  for (const SceneObject& o : scene.objects) {
    const ObjectModel* model = objects_(o.model);
    if (model == nullptr || !prepared_.insert(o.model).second) continue;
    auto problem = std::make_shared<std::string>();
    const auto prepare_by = [&](const std::function<Duration(const std::function<bool()>& cancelled)>& work) {
      bus_.run_job(
          [work, problem](const CancelToken& token) {
            try {
              return work([&token] { return token.cancelled(); });
            } catch (const ConfigError& e) {
              *problem = e.what();
              return Duration{};
            }
          },
          [this, problem] {
            if (!problem->empty()) bus_.set_degraded(*problem);
          });
    };
    std::vector<std::shared_ptr<GraspBook>> books{book_};
    for (std::size_t i = 1; i < arms_.size(); ++i) books.push_back(arms_[i].book);
    for (const auto& each : books)
      prepare_by([book = each, model](const std::function<bool()>& cancelled) {
        const auto page = book->page(*model, cancelled);
        return page ? kReadList : Duration{};
      });
    if (!transfers_) continue;
    prepare_by([book = book_, transfers = transfers_, model](const std::function<bool()>& cancelled) {
      const auto page = book->page(*model, cancelled);
      const auto taken = page ? transfers->taker_page(*model, cancelled) : nullptr;
      const auto table = taken ? transfers->table(*model, *page, cancelled) : nullptr;
      return table ? kReadList + from_seconds(2e-6 * static_cast<double>(table->doubles().pairs)) : Duration{};
    });
  }
}

void Node::answer(const GraspRequest& request) {
  const auto known = std::find_if(replies_.begin(), replies_.end(), [&](const GraspReply& r) { return r.id == request.id; });
  if (known != replies_.end()) {
    GraspReply again = *known;
    again.stamp = 0;
    reply_out_->publish(again);
    return;
  }
  if (std::find(pending_.begin(), pending_.end(), request.id) != pending_.end()) return;
  if (pending_.size() >= kMaxPending) {
    bus_.count_left_out("grasp requests: too many wait", 1);
    GraspReply reply;
    reply.id = request.id;
    reply.reason = kFull;
    reply_out_->publish(reply);
    return;
  }
  pending_.push_back(request.id);
  choose(request, true);
}

void Node::choose(const GraspRequest& request, bool reply) {
  struct Result {
    GraspReply reply;
  };
  auto result = std::make_shared<Result>();
  result->reply.id = request.id;
  const auto object =
      std::find_if(scene_.objects.begin(), scene_.objects.end(), [&](const SceneObject& o) { return o.id == request.object; });
  const ObjectModel* model = object != scene_.objects.end() ? objects_(object->model) : nullptr;
  if (object == scene_.objects.end()) {
    result->reply.reason = "object " + request.object + " is not in the scene";
  } else if (!scene_.robot_known) {
    result->reply.reason = "the place of the robot is not known yet";
  } else if (model == nullptr) {
    result->reply.reason = object->model.empty()
                               ? "object " + request.object + " is known by its outline only: grasps need a description of it"
                               : "object " + request.object + " is of model " + object->model + ", of which there is no description";
  } else if (request.start.size() != chooser_->robot().dof()) {
    result->reply.reason =
        "the start has " + std::to_string(request.start.size()) + " axes, the robot has " + std::to_string(chooser_->robot().dof());
  } else if (!request.group.empty() && request.group != "arm") {
    result->reply.reason = "grasps are planned for the group \"arm\", not for \"" + request.group + "\"";
  } else {
    T_world_proposed_ = object->T_world_object;
  }
  const bool work = result->reply.reason.empty();
  bus_.run_job(
      [book = book_, transfers = transfers_, chooser = chooser_, request, scene = scene_, people = people_, model, result,
       work](const CancelToken& token) {
        if (!work) return Duration{};
        const auto cancelled = [&token] { return token.cancelled(); };
        try {
          const auto page = book->page(*model, cancelled);
          if (!page) {
            result->reply.reason = "cancelled";
            return Duration{};
          }
          const auto table = transfers ? transfers->known(model->name) : nullptr;
          const Choice choice = chooser->choose(request, page->list, *page->object, scene, people, cancelled, table.get());
          result->reply.grasps = choice.grasps;
          result->reply.rejected = choice.refusals();
          for (Refusal& r : page->list.refusals()) result->reply.rejected.push_back(std::move(r));
          if (choice.grasps.empty()) result->reply.reason = choice.why_none(page->list);
          return choice_time(choice);
        } catch (const ConfigError& e) {
          result->reply.reason = e.what();
          return Duration{};
        }
      },
      [this, result, request, reply] {
        proposing_ = false;
        candidates_.object = request.object;
        candidates_.grasps = result->reply.grasps;
        if (!reply) return;
        std::erase(pending_, request.id);
        replies_.push_back(result->reply);
        if (replies_.size() > kRememberedReplies) replies_.pop_front();
        reply_out_->publish(result->reply);
        served_ = request;
        served_at_ = bus_.now();
        serving_ = true;
      });
}

std::string Node::objection(const RegraspRequest& request) const {
  if (arms_.size() != 2) return "the robot has " + std::to_string(arms_.size()) + " arms with hands, to pass an object it needs two";
  if (!scene_.robot_known) return "the place of the robot is not known yet";
  if (request.start.size() != chooser_->robot().dof())
    return "the start has " + std::to_string(request.start.size()) + " axes, the robot has " + std::to_string(chooser_->robot().dof());
  const auto object =
      std::find_if(scene_.objects.begin(), scene_.objects.end(), [&](const SceneObject& o) { return o.id == request.object; });
  if (object == scene_.objects.end()) return "object " + request.object + " is not in the scene";
  if (object->holder == Holder::robot || object->holder == Holder::human) return request.object + " is held: it must stand first";
  if (objects_(object->model) == nullptr) return "there is no description of " + request.object + ", grasps need one";
  return {};
}

void Node::answer(const RegraspRequest& request) {
  if (regrasp_pending_ == request.id) return;
  if (regrasp_reply_ && regrasp_reply_->id == request.id) {
    regrasp_reply_->stamp = 0;
    regrasp_out_->publish(*regrasp_reply_);
    return;
  }
  if (regrasps_waiting_ >= kMaxPending) {
    bus_.count_left_out("regrasp requests: too many wait", 1);
    RegraspReply reply;
    reply.id = request.id;
    reply.reason = kFull;
    regrasp_out_->publish(reply);
    return;
  }
  ++regrasps_waiting_;
  regrasp_pending_ = request.id;
  auto answer = std::make_shared<RegraspAnswer>();
  answer->reply.id = request.id;
  answer->reply.reason = objection(request);
  const bool work = answer->reply.reason.empty();
  const auto object =
      std::find_if(scene_.objects.begin(), scene_.objects.end(), [&](const SceneObject& o) { return o.id == request.object; });
  const ObjectModel* model = work ? objects_(object->model) : nullptr;
  bus_.run_job(
      [this, answer, request, model, scene = scene_](const CancelToken& token) {
        if (model == nullptr) return Duration{};
        try {
          *answer = answer_regrasp(request,
                                   {chooser_->robot(), arms_, objects_, scene, regrasp_settings_},
                                   *model, [&token] { return token.cancelled(); });
        } catch (const ConfigError& e) {
          answer->reply.reason = e.what();
        }
        return regrasp_time(*answer);
      },
      [this, answer] {
        --regrasps_waiting_;
        regrasp_pending_.reset();
        regrasp_reply_ = answer->reply;
        regrasp_out_->publish(*regrasp_reply_);
      });
}

void Node::propose(TimePoint now) {
  if (!serving_) return;
  if (to_seconds(now - served_at_) > settings_.candidates_time()) {
    serving_ = false;
    return;
  }
  const auto object =
      std::find_if(scene_.objects.begin(), scene_.objects.end(), [&](const SceneObject& o) { return o.id == served_.object; });
  if (object == scene_.objects.end() || object->holder == Holder::robot || object->holder == Holder::human) return;
  const bool moved = (object->T_world_object.translation() - T_world_proposed_.translation()).norm() > kMoved;
  if (moved && !proposing_) {
    proposing_ = true;
    choose(served_, false);
  }
  if (candidates_.grasps.empty()) return;
  candidates_.stamp = 0;
  candidates_out_->publish(candidates_);
}

}  // namespace handsel::grasp_planner

// SPDX-License-Identifier: MIT
// [GR sec. 5] Balls and boxes that fall on the ground, bounce and come to rest: rigid bodies simulated by Bullet.
#pragma once

#include <genrender/scene/animation.hpp>
#include <genrender/scene/primitives.hpp>

#include <btBulletDynamicsCommon.h>

#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace genrender::scenes {

/// A few textured balls and boxes dropped on a ground plane. The simulation runs at a fixed step when the scene is made
/// and all of its transforms are kept, so every frame is there at once and always the same. A model of animation.
class bouncing_balls {
public:
    /// `frame_count` frames, evenly spread over the simulated time: two seconds, or more than that at 24 frames a
    /// second.
    explicit bouncing_balls(std::size_t frame_count) : frame_count_(frame_count) {
        ground_ = pose({0}, std::make_shared<mesh const>(make_plane({16, 16}, 8)), glm::mat4(1));
        simulate();
    }

    std::size_t frame_count() const { return frame_count_; }

    posed_scene frame(frame_index i) const {
        posed_scene scene{look_at({0.9f, 2.75f, 6.1f}, {0, 0.95f, 0}, glm::radians(43.0f)), {ground_}};
        for (std::size_t body = 0; body < surfaces_.size(); ++body) {
            auto const number = object_index{static_cast<std::uint32_t>(body + 1)};
            scene.objects.push_back(pose(number, surfaces_[body], transforms_[i.value * surfaces_.size() + body]));
        }
        return scene;
    }

private:
    /// What falls: a ball of radius `size`, or a box with edges of twice `size`.
    struct falling_body {
        bool is_ball;
        float size;
        btVector3 position;
        btVector3 velocity;
        btVector3 spin;
    };

    static constexpr int steps_per_second = 480;

    static std::array<falling_body, 10> bodies() {
        return {{{true, 0.46f, {-1.15f, 2.35f, 0.25f}, {0.55f, 0.0f, 0.0f}, {0, 2, -4}},
                 {true, 0.34f, {0.95f, 1.4f, 0.75f}, {-0.35f, 2.2f, 0.1f}, {3, 0, 3}},
                 {true, 0.52f, {0.65f, 2.55f, -0.75f}, {-0.25f, -1.0f, 0.15f}, {-2, 1, 2}},
                 {true, 0.26f, {-0.35f, 0.95f, 1.35f}, {-0.3f, 2.2f, 0.0f}, {5, 0, 4}},
                 {true, 0.3f, {1.75f, 2.5f, -0.1f}, {-0.7f, 0.6f, 0.2f}, {0, 4, 6}},
                 {true, 0.38f, {-1.85f, 1.3f, -0.75f}, {0.3f, 2.0f, 0.2f}, {1, 3, -5}},
                 {true, 0.22f, {0.2f, 2.1f, 0.95f}, {0.35f, 1.0f, 0.15f}, {6, 0, -3}},
                 {false, 0.33f, {-0.3f, 2.8f, -0.35f}, {-0.3f, -0.5f, 0.25f}, {2.5f, 1, 3}},
                 {false, 0.26f, {1.55f, 0.9f, -1.0f}, {-0.2f, 2.6f, 0.35f}, {-3, 2, 1.5f}},
                 {false, 0.24f, {-1.4f, 2.6f, 0.7f}, {0.45f, 0.3f, 0.0f}, {1, -2, 4}}}};
    }

    void simulate() {
        btDefaultCollisionConfiguration configuration;
        btCollisionDispatcher dispatcher(&configuration);
        btDbvtBroadphase broadphase;
        btSequentialImpulseConstraintSolver solver;
        btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
        world.setGravity({0, -9.81f, 0});

        std::vector<std::unique_ptr<btCollisionShape>> shapes;
        std::vector<std::unique_ptr<btRigidBody>> rigid_bodies;
        auto const add = [&](std::unique_ptr<btCollisionShape> shape, btScalar mass, btScalar restitution,
                             btVector3 const& position) -> btRigidBody& {
            btVector3 inertia(0, 0, 0);
            if (mass > 0) {
                shape->calculateLocalInertia(mass, inertia);
            }
            btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
            info.m_startWorldTransform.setOrigin(position);
            info.m_friction = 0.5f;
            info.m_rollingFriction = 0.01f;
            info.m_restitution = restitution;
            rigid_bodies.push_back(std::make_unique<btRigidBody>(info));
            // Bullet brakes bodies before they touch, which would eat the bounce: let contacts begin at the surface.
            rigid_bodies.back()->setContactProcessingThreshold(0);
            shapes.push_back(std::move(shape));
            world.addRigidBody(rigid_bodies.back().get());
            return *rigid_bodies.back();
        };
        for (auto const& body : bodies()) {
            auto shape = body.is_ball ? std::unique_ptr<btCollisionShape>(std::make_unique<btSphereShape>(body.size))
                                      : std::make_unique<btBoxShape>(btVector3(body.size, body.size, body.size));
            auto const mass = (body.is_ball ? 4.0f : 6.0f) * body.size * body.size * body.size;
            auto& rigid = add(std::move(shape), mass, body.is_ball ? 0.85f : 0.5f, body.position);
            rigid.setLinearVelocity(body.velocity);
            rigid.setAngularVelocity(body.spin);
            rigid.setActivationState(DISABLE_DEACTIVATION);
            surfaces_.push_back(std::make_shared<mesh const>(body.is_ball ? make_sphere(body.size, 48)
                                                                          : make_box(glm::vec3(2 * body.size))));
        }
        // The ground, and unseen walls that keep the action in the picture.
        add(std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), 0.0f), 0, 1, {0, 0, 0});
        add(std::make_unique<btStaticPlaneShape>(btVector3(1, 0, 0), 0.0f), 0, 1, {-2.05f, 0, 0});
        add(std::make_unique<btStaticPlaneShape>(btVector3(-1, 0, 0), 0.0f), 0, 1, {2.1f, 0, 0});
        add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0.0f), 0, 1, {0, 0, -2.2f});
        add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, -1), 0.0f), 0, 1, {0, 0, 1.6f});

        auto const seconds = std::max(2.0, static_cast<double>(frame_count_) / 24);
        auto const spacing = frame_count_ > 1 ? seconds / static_cast<double>(frame_count_ - 1) : 0.0;
        long step = 0;
        for (std::size_t frame = 0; frame < frame_count_; ++frame) {
            for (auto const end = std::lround(static_cast<double>(frame) * spacing * steps_per_second); step < end;
                 ++step) {
                world.stepSimulation(btScalar(1) / steps_per_second, 0);
            }
            for (std::size_t body = 0; body < surfaces_.size(); ++body) {
                transforms_.push_back(to_matrix(rigid_bodies[body]->getWorldTransform()));
            }
        }
        for (auto const& body : rigid_bodies) {
            world.removeRigidBody(body.get());
        }
    }

    static glm::mat4 to_matrix(btTransform const& transform) {
        std::array<btScalar, 16> elements{};
        transform.getOpenGLMatrix(elements.data());
        glm::mat4 matrix;
        for (std::size_t i = 0; i < 16; ++i) {
            matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = static_cast<float>(elements[i]);
        }
        return matrix;
    }

    std::size_t frame_count_;
    posed_object ground_;
    std::vector<std::shared_ptr<mesh const>> surfaces_;
    std::vector<glm::mat4> transforms_; ///< object to world [frames, bodies]
};

} // namespace genrender::scenes

// The press in Bullet's deformable body: press_bullet MESH STEP_S NAME=VALUE…; writes one line of JSON.
//
// The law is btDeformableLinearElasticityForce's: linear elastic in the frame that the polar decomposition
// turns. Bullet has tolerances that are lengths and masses, for bodies of about a metre. Lengths are
// therefore SCALE times as large here and the density SCALE² times as small, so that waves cross the body in
// the same time.
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace {

/// Bullet's solver keeps its limits to itself; this one lets them be set.
struct DeformableSolver : btDeformableBodySolver {
  DeformableSolver() {
    m_maxNewtonIterations = 1;  // one linearised solve a step
    m_newtonTolerance = 0;      // also where little is left to be done
    m_cg.m_maxIterations = 2000;
    m_cr.m_maxIterations = 2000;
  }
};

struct Mesh {
  std::vector<btVector3> nodes;
  std::vector<std::array<int, 4>> tets;
};

/// Number of nodes and tets, places [m], tets. Nodes that are held come last, as Bullet's implicit step
/// wants.
Mesh read_mesh(const char* file, double scale) {
  std::ifstream in(file);
  std::size_t num_nodes = 0;
  std::size_t num_tets = 0;
  in >> num_nodes >> num_tets;
  Mesh mesh{std::vector<btVector3>(num_nodes), std::vector<std::array<int, 4>>(num_tets)};
  for (btVector3& node : mesh.nodes) {
    double x = 0;
    double y = 0;
    double z = 0;
    in >> x >> y >> z;
    node = btVector3(btScalar(scale * x), btScalar(scale * y), btScalar(scale * z));
  }
  for (auto& tet : mesh.tets) {
    for (int& node : tet) in >> node;
  }
  return mesh;
}

struct Material {
  double lambda, mu;  // [Pa]
  double density;     // of the scaled body
  double damping;     // Rayleigh's, of the stiffness [s]
};

btSoftBody* make_block(btSoftBodyWorldInfo& world, const Mesh& mesh, const Material& material,
                       double bottom) {
  std::vector<btScalar> mass(mesh.nodes.size(), 0);
  for (const auto& [a, b, c, d] : mesh.tets) {
    const btVector3& at = mesh.nodes[a];
    const double six = (mesh.nodes[b] - at).cross(mesh.nodes[c] - at).dot(mesh.nodes[d] - at);
    for (const int node : {a, b, c, d}) mass[node] += btScalar(material.density * six / 24);
  }
  auto* body = new btSoftBody(&world, int(mesh.nodes.size()), mesh.nodes.data(), mass.data());
  for (const auto& tet : mesh.tets) body->appendTetra(tet[0], tet[1], tet[2], tet[3]);
  for (const auto& tet : mesh.tets) {  // the search for contacts goes along the edges
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) body->appendLink(tet[i], tet[j], nullptr, true);
    }
  }
  btSoftBodyHelpers::generateBoundaryFaces(body);
  body->initializeDmInverse();
  body->m_tetraScratches.resize(body->m_tetras.size());
  body->m_tetraScratchesTn.resize(body->m_tetras.size());
  for (int i = 0; i < int(mesh.nodes.size()); ++i) {
    if (mesh.nodes[i].z() < bottom * (1 - 1e-6)) body->setMass(i, 0);
  }
  // Nodes against the ball. Faces against it, the other choice, let the ball sink in and give a third of the
  // force.
  body->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN;
  body->m_cfg.kKHR = 1;
  body->m_cfg.kCHR = 1;
  body->m_cfg.kDF = 0;
  body->m_cfg.drag = 0;
  body->m_sleepingThreshold = 0;
  body->setActivationState(DISABLE_DEACTIVATION);
  return body;
}

/// Sum of the elastic forces of the nodes that are free, along z: at rest what the ball bears.
double find_force(const btSoftBody& body, const Material& material) {
  double sum = 0;
  for (int e = 0; e < body.m_tetras.size(); ++e) {
    const btSoftBody::Tetra& tet = body.m_tetras[e];
    const btVector3 origin = tet.m_n[0]->m_x;
    btMatrix3x3 edges;
    for (int k = 0; k < 3; ++k) {
      const btVector3 edge = tet.m_n[k + 1]->m_x - origin;
      for (int row = 0; row < 3; ++row) edges[row][k] = edge[row];
    }
    const btMatrix3x3 F = edges * tet.m_Dm_inverse;
    const btMatrix3x3& R = body.m_tetraScratches[e].m_corotation;
    const btMatrix3x3 turned = R.transpose() * F;
    const btMatrix3x3 strain = (turned + turned.transpose()) * btScalar(0.5) - btMatrix3x3::getIdentity();
    const btScalar trace = strain[0][0] + strain[1][1] + strain[2][2];
    const btMatrix3x3 piola = R * (strain * btScalar(2 * material.mu) +
                                   btMatrix3x3::getIdentity() * btScalar(material.lambda * trace));
    const btMatrix3x3 gradient = piola * tet.m_Dm_inverse.transpose();
    for (int k = 0; k < 3; ++k) {
      const double pull = double(gradient[2][k]) * double(tet.m_element_measure);
      if (tet.m_n[k + 1]->m_im > 0) sum -= pull;
      if (tet.m_n[0]->m_im > 0) sum += pull;
    }
  }
  return sum;
}

}  // namespace

int main(int count, char** words) {
  std::map<std::string, double> given;
  for (int i = 3; i < count; ++i) {
    const std::string word = words[i];
    const std::size_t at = word.find('=');
    given[word.substr(0, at)] = std::stod(word.substr(at + 1));
  }
  const double step = std::stod(words[2]);
  const double scale = given.at("scale");
  const double radius = scale * given.at("radius");
  const double margin = scale * given.at("margin");
  const double nu = given.at("poisson");
  const double young = given.at("young");
  const Material material{young * nu / (1 + nu) / (1 - 2 * nu), young / (2 * (1 + nu)),
                          given.at("density") / (scale * scale), given.at("damping")};
  const Mesh mesh = read_mesh(words[1], scale);

  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  DeformableSolver solver;
  btDeformableMultiBodyConstraintSolver constraints;
  constraints.setDeformableSolver(&solver);
  auto* world =
      new btDeformableMultiBodyDynamicsWorld(&dispatcher, &broadphase, &constraints, &configuration, &solver);
  world->setGravity(btVector3(0, 0, 0));
  btSoftBodyWorldInfo& info = world->getWorldInfo();
  info.m_gravity.setZero();
  // The ball's distance is interpolated in cells of this size; in cells of 2.5 mm it lets the block come 0.2
  // mm nearer.
  info.m_sparsesdf.setDefaultVoxelsz(btScalar(scale * given.at("voxel")));
  info.m_sparsesdf.Reset();

  btSoftBody* block = make_block(info, mesh, material, -scale * given.at("height"));
  world->addSoftBody(block);
  block->getCollisionShape()->setMargin(btScalar(margin));
  world->addForce(block,
                  new btDeformableLinearElasticityForce(btScalar(material.mu), btScalar(material.lambda), 0,
                                                        btScalar(material.damping)));
  world->setImplicit(true);
  world->setLineSearch(false);
  world->setUseProjection(true);
  world->getSolverInfo().m_numIterations = 100;

  btTransform place;
  place.setIdentity();
  place.setOrigin(btVector3(0, 0, btScalar(radius + margin)));
  auto* ball = new btRigidBody(btRigidBody::btRigidBodyConstructionInfo(0, new btDefaultMotionState(place),
                                                                        new btSphereShape(btScalar(radius))));
  ball->setCollisionFlags(ball->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  ball->setActivationState(DISABLE_DEACTIVATION);
  ball->setFriction(0);
  world->addRigidBody(ball);

  const double end = given.at("end");
  const long steps = std::lround(end / step);
  const long num_held = std::lround(given.at("held") / step);
  std::vector<double> held;
  std::clock_t spent = 0;  // without what measures
  for (long i = 1; i <= steps; ++i) {
    const double share = std::min(double(i) * step / given.at("down"), 1.0);
    const double height = -scale * given.at("depth") * 0.5 * (1 - std::cos(M_PI * share));
    place.setOrigin(btVector3(0, 0, btScalar(radius + margin + height)));
    ball->getMotionState()->setWorldTransform(place);
    ball->setWorldTransform(place);
    ball->setInterpolationWorldTransform(place);
    const std::clock_t before = std::clock();
    world->stepSimulation(btScalar(step), 0, btScalar(step));
    spent += std::clock() - before;
    if (i > steps - num_held) held.push_back(find_force(*block, material) / (scale * scale));
  }
  std::sort(held.begin(), held.end());
  std::printf("{\"force_N\": %.9g, \"swing_N\": %.9g, \"cpu_s\": %.6g}\n", held[held.size() / 2],
              held.back() - held.front(), double(spent) / CLOCKS_PER_SEC);
}

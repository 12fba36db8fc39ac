// The press in MuJoCo's flex: press_mujoco.mjs FOLDER_OF_MUJOCO PROBLEM.json; writes one line of JSON.
// A flex of tets is Saint Venant and Kirchhoff's solid. Its elastic forces are explicit in time, its contacts constraints.
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [folder, file] = process.argv.slice(2);
const problem = JSON.parse(fs.readFileSync(file));
const { default: load } = await import(pathToFileURL(path.resolve(folder, 'dist/mujoco_wasm.js')));
const mujoco = await load();
const flat = (rows) => rows.map((row) => row.join(' ')).join(' ');

// The ball is a body without mass that is led. A contact of solref 2 ms and solimp 0.999 gives way by less than 1 % of the depth.
// Without damping a flex never rests: each joint of a node has some, which the integrator takes implicitly.
const contact = 'condim="1" solref="0.002 1" solimp="0.99 0.999 0.0001"';
const model_xml = `<mujoco>
  <option timestep="${problem.step_s}" gravity="0 0 0" integrator="implicitfast" solver="Newton" tolerance="1e-8"/>
  <size memory="400M"/>
  <default><joint damping="${problem.damping}"/></default>
  <worldbody>
    <body name="ball" mocap="true" pos="0 0 ${problem.radius_m}">
      <geom type="sphere" size="${problem.radius_m}" ${contact}/>
    </body>
    <flexcomp name="block" type="direct" dim="3" radius="${problem.skin_m}" mass="${problem.mass_kg}"
              point="${flat(problem.nodes)}" element="${flat(problem.tets)}">
      <elasticity young="${problem.youngs_modulus_Pa}" poisson="${problem.poissons_ratio}"/>
      <contact ${contact} selfcollide="none" internal="false"/>
      <pin id="${problem.held.join(' ')}"/>
    </flexcomp>
  </worldbody>
</mujoco>`;
mujoco.FS.writeFile('/press.xml', model_xml);
const model = mujoco.MjModel.loadFromXML('/press.xml');
const data = new mujoco.MjData(model);

/** Of the ball on the block, downwards: what the constraints add to the nodes' own z. */
function force() {
  let sum = 0;
  for (let k = 2; k < model.nv; k += 3) sum -= data.qfrc_constraint[k];
  return sum;
}

const steps = problem.height_m.length;
const held = [];
const before = process.cpuUsage();
for (let i = 0; i < steps; ++i) {
  data.mocap_pos[2] = problem.radius_m + problem.skin_m + problem.height_m[i];
  mujoco.mj_step(model, data);
  if (i >= steps - problem.steps_held) held.push(force());
}
const { user, system } = process.cpuUsage(before);
held.sort((a, b) => a - b);
console.log(JSON.stringify({
  force_N: held[held.length >> 1], swing_N: held[held.length - 1] - held[0], cpu_s: (user + system) / 1e6,
  version: mujoco.mj_versionString(),
}));

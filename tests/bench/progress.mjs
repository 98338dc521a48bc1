// SPDX-License-Identifier: GPL-3.0-or-later
// How far the remaining time that a running job gives can be relied on: long jobs of every craft, natively.
//   node tests/bench/progress.mjs build/formwright [NAME...] [--trace FILE]
//   node tests/bench/progress.mjs build/formwright [OPERATION | RUN...] --record core/job/progress/usual_time_shares.cpp
// An operation that is named has all its known runs made anew; a known run that is named is added to those there are.
// Prints for each job its seconds, the share of its run during which a remaining time was given, the share of those
// moments at which it was within a factor of 1.5 of what the run then took, and where the shown fraction differed
// most from the share of the time that had passed. --trace writes every message: seconds, fraction, stage, seconds left.
import { spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { createInterface } from 'node:readline';
import { strToU8, zipSync } from 'fflate';
import { machine, round } from './jobs.mjs';

const job = (operation, parameters, inputs = {}, outputs) => ({ operation, parameters, inputs, ...(outputs ? { outputs } : {}) });
/** An input that is an output of another job. */
const made = (maker, output) => ({ maker, output });
const model = (name, vertices) => made(job('import', {}, { mesh: { sample: name, vertices } }), 'model.ply');
const relief = (name, vertices, parameters = {}, outputs) => job('relief', parameters, { mesh: model(name, vertices) }, outputs);
const forming = (operation, name, vertices, parameters = {}) => job(operation, parameters, { mould: model(name, vertices) });
const design = (name, vertices, width_mm = 20, size_mm = 300) => job('zippable-design', { width_mm, size_mm }, { mesh: model(name, vertices) });
const zipping = (name, vertices, width_mm = 20) => job('zippable-simulate', {}, { design: made(design(name, vertices, width_mm), 'design.json') });
const small = { size_mm: 60, sheet_x_mm: 130, sheet_y_mm: 130, clamp_opening_x_mm: 110, clamp_opening_y_mm: 110, platform_travel_mm: 60 };
const measured = (name, fault) => made(job('evidence-virtual-object', { ...small, points: 300, triangles: 1500, ...fault }, { mould: { sample: name } }, ['object.zip']), 'object.zip');
const diagnosing = (operation, parameters, name, fault) => job(operation, parameters, { object: measured(name, fault) });

const light = (name, vertices, parameters = {}) => job('relief-light', parameters, { mesh: model(name, vertices) });
const planPoints = (name, parameters = {}) => job('evidence-plan-points', { ...small, ...parameters }, { mould: { sample: name } });
/** What was sewn, measured with a tape: all twenty lengths are `stretch` times as long as designed. */
const sewn = (name, vertices, stretch) => {
  const designed = made(design(name, vertices, 25, 200), 'design.json');
  const lengths = made(job('evidence-plan-lengths', {}, { design: designed }), 'lengths.csv');
  const measuredLengths = (file) => {
    const [header, ...rows] = String(file).trim().split('\n');
    const measuredRow = (row) => row.split(',').map((cell, k, cells) => (k === 3 ? (stretch * Number(cells[5])).toFixed(1) : cell));
    return [header, ...rows.map((row) => measuredRow(row).join())].join('\n') + '\n';
  };
  const packed = ([file, table]) => zipSync({ 'design.json': file, 'lengths.csv': strToU8(measuredLengths(table)) });
  return { pack: packed, of: [designed, lengths], file_name: 'object.zip', key: `sewn ${name} ${vertices} ${stretch}` };
};
const diagnosingSewn = (name, vertices, stretch, parameters = {}) => job('evidence-diagnose-zippable', parameters, { object: sewn(name, vertices, stretch) });

/** What is known of how an operation spends its time comes from these. */
const recorded = {
  relief_bust: relief('bust', 200000),
  relief_octopus_thin: relief('octopus', 100000, { thickness_mm: 2 }),
  relief_cat: relief('cat', 150000),
  relief_coin_thin: relief('coin', 40000, { thickness_mm: 1 }),
  relief_fish: relief('fish', 120000, { thickness_mm: 6 }),
  relief_heart_thin: relief('heart', 60000, { thickness_mm: 1.5 }),
  relief_bust_balanced: relief('bust', 60000, { appearance: 'balanced' }),
  relief_fish_balanced: relief('fish', 60000, { appearance: 'balanced', thickness_mm: 3 }),
  relief_cat_balanced: relief('cat', 40000, { appearance: 'balanced', thickness_mm: 8 }),
  relief_mountain_balanced: relief('mountain', 60000, { appearance: 'balanced' }),
  relief_heart_balanced: relief('heart', 50000, { appearance: 'balanced', thickness_mm: 2 }),
  relief_coin_balanced: relief('coin', 50000, { appearance: 'balanced', thickness_mm: 6 }),
  relief_bust_balanced_thin: relief('bust', 90000, { appearance: 'balanced', thickness_mm: 2 }),
  simulate_bust: forming('thermoform-simulate', 'bust', 60000, { triangles: 20000 }),
  simulate_cat: forming('thermoform-simulate', 'cat', 20000, { triangles: 15000 }),
  simulate_t_shape: forming('thermoform-simulate', 't_shape', 30000, { triangles: 30000 }),
  simulate_fish: forming('thermoform-simulate', 'fish', 30000, { triangles: 25000 }),
  simulate_star: forming('thermoform-simulate', 'star', 20000, { triangles: 40000 }),
  texture_cat: forming('thermoform-texture', 'cat', 40000, { triangles: 20000 }),
  texture_octopus: forming('thermoform-texture', 'octopus', 40000, { triangles: 15000 }),
  texture_bust: forming('thermoform-texture', 'bust', 60000, { triangles: 25000 }),
  texture_coin: forming('thermoform-texture', 'coin', 30000, { triangles: 15000 }),
  mould_octopus: forming('thermoform-mould', 'octopus', 150000),
  mould_bust: forming('thermoform-mould', 'bust', 150000),
  mould_star: forming('thermoform-mould', 'star', 100000),
  design_octopus: design('octopus', 60000),
  design_cat: design('cat', 40000, 15),
  design_t_shape: design('t_shape', 60000),
  design_bust: design('bust', 60000),
  design_fish: design('fish', 40000, 30),
  design_pyramid: design('pyramid', 40000, 15),
  zipping_star: zipping('star', 2000),
  zipping_heart: zipping('heart', 1200, 30),
  zipping_wide_star: zipping('star', 2500, 30),
  zipping_wide_heart: zipping('heart', 900, 40),
  diagnose_pyramid: diagnosing('evidence-diagnose', { triangles: 1500 }, 'pyramid', { heating_gradient_x: 0.5 }),
  diagnose_t_shape: diagnosing('evidence-diagnose', { triangles: 1000 }, 't_shape', { weak_vacuum: 0.4 }),
  diagnose_clean: diagnosing('evidence-diagnose', { triangles: 1500 }, 'pyramid', {}),
  diagnose_cone: diagnosing('evidence-diagnose', { triangles: 1500 }, 'mountain', { thickness_wedge_x: 0.3 }),
  diagnose_hemisphere: diagnosing('evidence-diagnose', { triangles: 1000 }, 'hemisphere', { heating_centre: 0.5 }),
  diagnose_star: diagnosing('evidence-diagnose', { triangles: 1500 }, 'star', { mould_shift_x_mm: 1.5 }),
  diagnose_t_shape_without_pairs: diagnosing('evidence-diagnose', { triangles: 1500, pairs: false }, 't_shape', { scan_shift_x_mm: 1 }),
  diagnose_pyramid_without_pairs: diagnosing('evidence-diagnose', { triangles: 1000, pairs: false }, 'pyramid', { weak_vacuum: 0.5 }),
  diagnose_clean_without_pairs: diagnosing('evidence-diagnose', { triangles: 1500, pairs: false }, 'pyramid', {}),
  diagnose_hemisphere_without_pairs: diagnosing('evidence-diagnose', { triangles: 1500, pairs: false }, 'hemisphere', { heating_gradient_x: 0.4 }),
  diagnose_t_shape_clean_without_pairs: diagnosing('evidence-diagnose', { triangles: 1000, pairs: false }, 't_shape', {}),
  diagnose_cone_without_pairs: diagnosing('evidence-diagnose', { triangles: 1500, pairs: false }, 'mountain', { thickness_wedge_x: 0.3 }),
  forest_pillars: job('relief-forest', {}),
  forest_screens: job('relief-forest', { layout: 'screens' }),
  forest_fine: job('relief-forest', { seed: 2, pixel_mm: 0.8 }),
  forest_grid: job('relief-forest', { layout: 'grid' }),
  forest_wide_grid: job('relief-forest', { layout: 'grid', seed: 5, grid_columns: 6, grid_rows: 6 }),
  light_bust: light('bust', 60000),
  light_octopus: light('octopus', 40000, { thickness_mm: 8 }),
  light_cat_sky: light('cat', 40000, { light: 'overcast' }),
  light_bust_sky: light('bust', 60000, { light: 'overcast' }),
  light_heart_sky: light('heart', 80000, { light: 'overcast', thickness_mm: 3 }),
  plan_points_pyramid: planPoints('pyramid', { triangles: 2500 }),
  plan_points_t_shape: planPoints('t_shape', { triangles: 2500, mark_count: 20 }),
  plan_points_cone: planPoints('mountain', { triangles: 2500, mark_count: 6 }),
  plan_points_cat: planPoints('cat', { triangles: 2000 }),
  plan_points_octopus: planPoints('octopus', { triangles: 3000 }),
  plan_points_fine: planPoints('pyramid', { triangles: 2500, mark_spacing_mm: 5 }),
  diagnose_sewn_star: diagnosingSewn('star', 1500, 1.03),
  diagnose_sewn_heart: diagnosingSewn('heart', 1200, 1.02),
  diagnose_sewn_star_small: diagnosingSewn('star', 1000, 0.98),
  calibrate_pyramid: diagnosing('evidence-calibrate', { triangles: 3000 }, 'pyramid', { young_modulus_pa: 3300000 }),
  calibrate_t_shape: diagnosing('evidence-calibrate', { triangles: 3000 }, 't_shape', { young_modulus_pa: 2500000 }),
  calibrate_hemisphere: diagnosing('evidence-calibrate', { triangles: 5000 }, 'hemisphere', { young_modulus_pa: 3000000 }),
  calibrate_cone: diagnosing('evidence-calibrate', { triangles: 3000 }, 'mountain', { young_modulus_pa: 2500000 }),
  calibrate_star: diagnosing('evidence-calibrate', { triangles: 4000 }, 'star', {}),
};
/** Other models, sizes and parameters: on these the remaining times are judged. */
const judged = {
  relief_octopus: relief('octopus', 200000),
  relief_mountain: relief('mountain', 150000, { thickness_mm: 3 }),
  relief_star_thin: relief('star', 60000, { thickness_mm: 1 }),
  relief_fish_thin: relief('fish', 50000, { thickness_mm: 1.5 }),
  relief_octopus_balanced: relief('octopus', 60000, { appearance: 'balanced' }),
  relief_star_balanced: relief('star', 80000, { appearance: 'balanced', thickness_mm: 3 }),
  thermoform_simulate_mountain: forming('thermoform-simulate', 'mountain', 40000, { triangles: 30000 }),
  thermoform_simulate_octopus: forming('thermoform-simulate', 'octopus', 40000, { triangles: 20000 }),
  thermoform_texture_fish: forming('thermoform-texture', 'fish', 40000, { triangles: 20000 }),
  thermoform_texture_mountain: forming('thermoform-texture', 'mountain', 40000, { triangles: 30000 }),
  thermoform_mould_cat: forming('thermoform-mould', 'cat', 150000),
  zippable_design_cat: design('cat', 60000, 25),
  zippable_design_star: design('star', 60000, 15),
  zippable_design_heart: design('heart', 60000),
  zippable_simulate_star: zipping('star', 2500, 25),
  zippable_simulate_heart: zipping('heart', 1000, 35),
  evidence_diagnose_hemisphere: diagnosing('evidence-diagnose', { triangles: 1500 }, 'hemisphere', { scan_shift_x_mm: 1 }),
  evidence_diagnose_without_pairs: diagnosing('evidence-diagnose', { triangles: 1000, pairs: false }, 'hemisphere', { weak_vacuum: 0.5 }),
  evidence_diagnose_t_shape_without_pairs: diagnosing('evidence-diagnose', { triangles: 1500, pairs: false }, 't_shape', { heating_gradient_y: 0.4 }),
  relief_forest_grid: job('relief-forest', { layout: 'grid', seed: 3 }),
  relief_light_fish: light('fish', 60000, { thickness_mm: 3 }),
  relief_light_mountain_sky: light('mountain', 60000, { light: 'overcast' }),
  evidence_plan_points_hemisphere: planPoints('hemisphere', { triangles: 3000 }),
  evidence_diagnose_sewn_t_shape: diagnosingSewn('t_shape', 1500, 1.02),
  evidence_calibrate_pyramid: diagnosing('evidence-calibrate', { triangles: 4000 }, 'pyramid', { young_modulus_pa: 2000000 }),
};

/** Runs one job in a process of its own: its messages with their seconds, its end and the bytes of its outputs. */
function run(program, message, files) {
  const folder = mkdtempSync(path.join(os.tmpdir(), 'formwright-progress-'));
  const blobs = {};
  for (const [hash, bytes] of Object.entries(files)) writeFileSync((blobs[hash] = path.join(folder, hash)), bytes);
  const child = spawn(program, ['run-jobs'], { stdio: ['pipe', 'pipe', 'inherit'] });
  const start = performance.now();
  child.stdin.write(JSON.stringify({ run: 'x', job: message, blobs, outputs: folder, time_shares: true }) + '\n');
  return new Promise((resolve, reject) => {
    const said = [];
    child.on('exit', (code) => reject(new Error(`the native program ended with ${code}`)));
    createInterface({ input: child.stdout }).on('line', (line) => {
      const seconds = (performance.now() - start) / 1e3;
      const answer = JSON.parse(line);
      if (answer.progress) said.push([seconds, answer.fraction, answer.stage, answer.seconds_left]);
      if (!answer.finished) return;
      child.removeAllListeners('exit');
      child.kill();
      const { error, outputs = {} } = answer.result;
      const bytes = Object.fromEntries(Object.keys(outputs).map((name) => [name, readFileSync(path.join(folder, name))]));
      rmSync(folder, { recursive: true });
      if (error) reject(new Error(`${message.operation}: ${error.message}`));
      else resolve({ seconds, said, bytes, timed: answer.time_shares });
    });
  });
}

const kept = new Map(); // outputs of makers, by their messages

/** An output of another job, or what is packed of several. */
async function bytesOf(program, input) {
  const key = input.pack ? input.key : JSON.stringify(input);
  if (!kept.has(key)) {
    if (!input.pack) kept.set(key, (await runWithInputs(program, { ...input.maker, outputs: [input.output] })).bytes[input.output]);
    else {
      const files = [];
      for (const part of input.of) files.push(await bytesOf(program, part));
      kept.set(key, input.pack(files));
    }
  }
  return kept.get(key);
}

/** Runs a job after those that make its inputs. */
async function runWithInputs(program, message) {
  const files = {};
  const inputs = {};
  for (const [name, input] of Object.entries(message.inputs)) {
    if (!input.maker && !input.pack) {
      inputs[name] = input;
      continue;
    }
    const bytes = await bytesOf(program, input);
    const sha256 = createHash('sha256').update(bytes).digest('hex');
    files[sha256] = bytes;
    inputs[name] = { sha256, file_name: input.pack ? input.file_name : input.output };
  }
  return await run(program, { ...message, inputs }, files);
}

/** What is shown at each moment is the newest message; moments are every 20 ms of the run. */
function judge({ seconds, said }) {
  const step = 0.02;
  let [shown, within, moments, off, offAt] = [0, 0, 0, 0, null];
  for (let now = 0, k = -1; now < seconds; now += step, ++moments) {
    while (k + 1 < said.length && said[k + 1][0] <= now) ++k;
    if (k < 0) continue;
    const [at, fraction, stage, left] = said[k];
    const apart = Math.abs(fraction - now / seconds);
    if (apart > off) [off, offAt] = [apart, `${stage}: ${Math.round(100 * fraction)} % after ${Math.round((100 * now) / seconds)} %`];
    if (left === null) continue;
    ++shown;
    const shownLeft = Math.max(left - (now - at), 0);
    const truth = seconds - now;
    if (Math.max(shownLeft, 0.5) <= 1.5 * Math.max(truth, 0.5) && Math.max(truth, 0.5) <= 1.5 * Math.max(shownLeft, 0.5)) ++within;
  }
  return { seconds: round(seconds), given_share: round(shown / moments), within_share: shown > 0 ? round(within / shown) : null, fraction_off: round(off), fraction_off_at: offAt };
}

const words = process.argv.slice(2);
const option = (name) => {
  const at = words.indexOf(name);
  return at < 0 ? null : words.splice(at, 2)[1];
};
const trace = option('--trace');
const table = option('--record');
const [program, ...names] = words;
if (!program) throw new Error('Name the native program: node tests/bench/progress.mjs build/formwright');

if (table) {
  const source = readFileSync(table, 'utf8');
  const at = source.indexOf('shares{') + 'shares{'.length;
  const end = source.indexOf('};', at);
  const anew = (operation) => names.length === 0 || names.includes(operation);
  const chosen = Object.entries(recorded).flatMap(([name, message]) => (anew(message.operation) || names.includes(name) ? [message] : []));
  const rows = [...source.slice(at, end).matchAll(/^ *\{"([^"]+)",[^"]*?\}\},$/gm)]
    .filter(([, alike]) => !anew(alike.split(' ')[0]))
    .map(([row]) => row.trim());
  for (const message of chosen) {
    const { seconds, timed } = await runWithInputs(program, message);
    console.error(message.operation, round(seconds));
    if (timed === null) throw new Error(`${message.operation} ended within a second: use a larger model`);
    const pairs = timed.shares.flatMap((share, k) => (Math.round(1000 * share) > 0 ? [`{${k}, ${Math.round(1000 * share)}}`] : []));
    rows.push(`{"${timed.alike}", {${pairs.join(', ')}}},`);
  }
  writeFileSync(table, `${source.slice(0, at)}${rows.sort().map((row) => `\n      ${row}`).join('')}\n  ${source.slice(end)}`);
  process.exit();
}

const rows = {};
const traces = {};
for (const [name, message] of Object.entries(judged)) {
  if (names.length > 0 && !names.includes(name)) continue;
  const ran = await runWithInputs(program, message);
  rows[name] = judge(ran);
  traces[name] = { seconds: ran.seconds, said: ran.said };
  console.error(name, JSON.stringify(rows[name]));
}
if (trace) writeFileSync(trace, JSON.stringify(traces));
console.log(JSON.stringify({ machine: machine(), jobs: rows }, null, 2));

// SPDX-License-Identifier: GPL-3.0-or-later
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import { describe, expect, it } from 'vitest';
import type { Catalog, Operation, ParameterSchema } from '../../jobs/contract';
import type { LaserSheet } from '../../machines/laser_sheet';
import type { CraftModel, CraftResult } from '../../shared/session/craft_document';
import type { HeldBackend } from '../../shared/session/test_room';
import { settled, testServices } from '../../shared/session/test_room';
import { planBytes } from './make_product';
import { sheetWords } from './sheet_size_row';
import { design, planning, zippable } from './zippable_document';
import { ZippableSession } from './zippable_session';

const number = (value: number): ParameterSchema => ({ type: 'number', default: value });
const operation = (name: string, properties: Record<string, ParameterSchema>): Operation => ({
  name,
  title: name,
  inputs: [],
  parameters: { properties },
  outputs: [{ name: 'plan.svg', media_type: 'image/svg+xml', label: 'Plan' }],
});
const catalog: Catalog = {
  version: '',
  operations: [
    operation(design, { width_mm: number(20) }),
    operation(planning, {
      bed_x_mm: number(600),
      bed_y_mm: number(300),
      kerf_mm: number(0.15),
      margin_mm: number(5),
    }),
  ],
  samples: [],
  mesh_formats: [],
};
const laser = (name: string, bed_x_mm: number, bed_y_mm: number): LaserSheet => ({
  laser: name,
  bed_x_mm,
  bed_y_mm,
  material: null,
  kerf_mm: null,
});
const practice = laser('Practice laser', 400, 400);
const workshop = laser('Workshop', 600, 300);
const large = laser('Large', 1300, 900);

const blob = (digit: string) => ({ blob: digit.repeat(64), bytes: 1, media_type: 'x' });
const model: CraftModel = {
  source: { kind: 'sample', sample: 'star', title: 'Star' },
  mesh: blob('a'),
  preview: blob('b'),
  report: {},
};
const ribbon: CraftResult = {
  id: 'r',
  made_unix_s: 0,
  backend: 'wasm',
  seconds: 1,
  mesh: model.mesh.blob,
  parameters: {},
  report: {},
  outputs: { 'design.json': blob('d') },
};

/** With plain spaces. */
const words = (session: ZippableSession) => sheetWords(session).replaceAll('\u2009', ' ');

function room(chosen: LaserSheet | null = practice) {
  const inUse = signal(chosen);
  const services = testServices(catalog);
  const session = new ZippableSession(services, inUse);
  session.model.load = () => Promise.resolve();
  const { projects } = services;
  const takeRibbon = () => {
    projects.do(zippable.command({ label: 'Take' }, () => ({ model }) as object));
    projects.do(zippable.addResult(ribbon));
  };
  takeRibbon();
  /** What the plan was asked for with. */
  const makePlan = async () => {
    const made = planBytes(session, 'plan.svg', 'plan');
    const run = (services.browser as HeldBackend).runs.at(-1);
    run?.finish('plan.svg');
    await made;
    return (run?.asked as { parameters: object }).parameters;
  };
  return { inUse, session, projects, makePlan, takeRibbon };
}

describe('the sheets of a cutting plan', () => {
  it('are as large as the chosen laser’s bed, with the kerf of its material', async () => {
    const { inUse, session, makePlan } = room(null);
    expect(session.sheets.parameters.value).toEqual({}); // nothing is known of lasers yet
    inUse.value = { ...practice, material: 'Felt 3 mm', kerf_mm: 0.25 };
    expect(words(session)).toBe('Practice laser: 400 × 400 mm');
    expect(await makePlan()).toEqual({ bed_x_mm: 400, bed_y_mm: 400, kerf_mm: 0.25 });
    expect(session.plan.value).not.toBeNull();
  });

  it('keep a size that is set by hand, whichever laser is chosen; it can be undone and given back', async () => {
    const { inUse, session, projects, makePlan } = room();
    session.setParameters({ bed_x_mm: 600 }, 'Set');
    expect(words(session)).toBe('Set by hand: 600 × 400 mm');
    expect(await makePlan()).toEqual({ bed_y_mm: 400 }); // 600 is the operation's own
    inUse.value = workshop; // where 600 is the laser's, too
    session.setParameters({ margin_mm: 6 }, 'Set');
    inUse.value = large;
    expect(session.sheets.parameters.value).toEqual({ bed_y_mm: 900, margin_mm: 6 });
    session.sheets.useLaser();
    expect(session.sheets.parameters.value).toEqual({ bed_x_mm: 1300, bed_y_mm: 900, margin_mm: 6 });
    expect(projects.undoLabel.value).toBe('Lay out for Large');
    projects.undo();
    expect(session.sheets.parameters.value).toEqual({ bed_y_mm: 900, margin_mm: 6 });
    projects.undo();
    projects.undo();
    expect(words(session)).toBe('Large: 1300 × 900 mm');
  });

  it('follow another laser that is chosen while the project is open, and no other kerf', async () => {
    const { inUse, session, makePlan } = room();
    await makePlan();
    inUse.value = { ...practice, material: 'Felt 3 mm', kerf_mm: 0.25 };
    expect(session.plan.value).not.toBeNull(); // the sheets that are left go with those that are cut
    inUse.value = large;
    expect(session.plan.value).toBeNull();
    expect(await makePlan()).toEqual({ bed_x_mm: 1300, bed_y_mm: 900 });
  });

  it('stay as they were laid out when the project is opened while another laser is chosen', async () => {
    const { inUse, session, projects, makePlan } = room();
    await makePlan();
    const kept = session.plan.value;
    const first = projects.document.value.id;
    await projects.create();
    inUse.value = large;
    expect(session.sheets.parameters.value).toEqual({ bed_x_mm: 1300, bed_y_mm: 900 });
    await projects.open(first);
    await settled();
    expect(session.plan.value).toEqual(kept);
    expect(words(session)).toBe('Practice laser: 400 × 400 mm');
    session.sheets.useLaser();
    expect(session.plan.value).toBeNull();
    projects.undo();
    expect(session.plan.value).toEqual(kept);
  });

  it('stay as they were in a project that was laid out before lasers were asked', async () => {
    const { session, projects, makePlan } = room(null);
    expect(await makePlan()).toEqual({});
    const stored = projects.document.value;
    expect(zippable.of(stored).laid_out_for).toBeNull();
    const later = new ZippableSession(session.services, signal(practice));
    expect(later.plan.value).not.toBeNull();
    expect(words(later)).toBe('600 × 300 mm, as laid out before');
    later.sheets.useLaser();
    expect(later.sheets.parameters.value).toEqual({ bed_x_mm: 400, bed_y_mm: 400 });
  });

  it('are laid out for the machine that did not take one: its laser’s, or by hand for another', () => {
    const { session } = room();
    session.setParameters({ bed_x_mm: 700, bed_y_mm: 500 }, 'Set');
    session.sheets.useBed([400, 400]);
    expect(words(session)).toBe('Practice laser: 400 × 400 mm');
    session.sheets.useBed([350, 250]);
    expect(words(session)).toBe('Set by hand: 350 × 250 mm');
  });
});

// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { h, render } from 'preact';
import { beforeEach, expect, it } from 'vitest';
import type { Catalog } from '../../jobs/contract';
import { ReliefSession } from '../../crafts/relief/relief_session';
import { ThermoformSession } from '../../crafts/thermoform/thermoform_session';
import { ZippableSession } from '../../crafts/zippable/zippable_session';
import { settled, testServices } from '../../shared/session/test_room';
import { ToastLayer } from '../../ui';
import { openSampleLink } from './open_link';

const file = resolve(import.meta.dirname, '../../../../tests/job/catalog.json');
const catalog = JSON.parse(readFileSync(file, 'utf8')) as Catalog;
let services: ReturnType<typeof testServices>;
let sessions: { relief: ReliefSession; thermoform: ThermoformSession; zippable: ZippableSession };
const open = (rest: string) => openSampleLink(`#/open?v=1&name=Shared&${rest}`, services, sessions);
const alert = () => document.querySelector('[role=alert]')?.textContent;

beforeEach(async () => {
  services = testServices(catalog);
  sessions = {
    relief: new ReliefSession(services),
    thermoform: new ThermoformSession(services),
    zippable: new ZippableSession(services),
  };
  services.projects.do({
    label: 'work',
    apply: (document) => ({
      ...document,
      name: 'Mine',
      crafts: { relief: { parameters: { up: [1, 0, 0] } } },
    }),
  });
  document.body.innerHTML = '';
  render(h(ToastLayer, null), document.body.appendChild(document.createElement('div')));
  await settled();
});

it('opens a new project with the sample and the settings in every room; what was open is saved', async () => {
  const mine = services.projects.document.value.id;
  const opening = open('thermoform=bust&thermoform.yield_strain=0.15&relief=bust&relief.up=0,0,1');
  await settled();
  services.browser.runs[0]?.finish('model.ply'); // the import; both rooms have the model of it
  await opening;
  expect(
    services.browser.runs.map(({ asked }) => (typeof asked === 'string' ? asked : asked.operation)),
  ).toContain('import');
  const { id, name } = services.projects.document.value;
  expect(id).not.toBe(mine);
  expect(name).toBe('Shared');
  expect(services.projects.projects.value.map((one) => one.name)).toContain('Mine');
  expect(sessions.thermoform.document.value.parameters).toEqual({ yield_strain: 0.15 });
  expect(sessions.relief.document.value.parameters).toEqual({ up: [0, 0, 1] });
  expect(sessions.relief.document.value.model?.source).toMatchObject({ sample: 'bust' });
  expect(sessions.zippable.document.value.model).toBeNull();
});

it('what cannot be read leaves the open project as it is, and is said once', async () => {
  const before = services.projects.document.value;
  for (const rest of ['relief=lion', 'relief=bust&relief.__proto__=1', 'relief=bust&relief.up=x', '']) {
    await open(rest);
    expect(services.projects.document.value).toBe(before);
    expect(services.browser.runs).toEqual([]);
  }
  await settled();
  expect(alert()).toMatch(/^This link/);
});

it('nothing of it gets into a project that is opened meanwhile', async () => {
  const opening = open('relief=bust&relief.up=0,0,1');
  await settled();
  await services.projects.create('Another');
  services.browser.runs[0]?.finish('model.ply');
  await opening;
  expect(services.projects.document.value.name).toBe('Another');
  expect(services.projects.document.value.crafts).toEqual({});
});

// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import type { LoggedJob } from './job_log';
import { JobLog } from './job_log';

const job = (id: string, ended: string | null = null): LoggedJob => ({
  id,
  name: id,
  machine: 'Laser',
  started_unix_s: 0,
  seconds: null,
  ended,
  lines: 2,
  lines_done: 1,
});

class Shelf {
  text: string | null = null;
  getItem = () => this.text;
  setItem = (_: string, text: string) => {
    this.text = text;
  };
}

it('two tabs that were opened together keep what the other one wrote', () => {
  const shelf = new Shelf();
  const [one, two] = [new JobLog(shelf), new JobLog(shelf)];
  one.put(job('a'));
  two.put(job('b'));
  one.put(job('a', 'done'));
  expect(new JobLog(shelf).jobs.value).toEqual([job('a', 'done'), job('b')]);
});

it('a damaged log begins anew, and one that cannot be written lasts as long as the page', () => {
  const shelf = new Shelf();
  shelf.text = '{"a';
  const log = new JobLog(shelf);
  expect(log.jobs.value).toEqual([]);
  shelf.setItem = () => {
    throw new DOMException('full', 'QuotaExceededError');
  };
  log.put(job('a'));
  log.put(job('b'));
  expect(log.jobs.value.map(({ id }) => id)).toEqual(['b', 'a']);
});

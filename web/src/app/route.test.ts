// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it, vi } from 'vitest';
import { place, startRouting } from './route';

const turn = () => new Promise((resolve) => setTimeout(resolve, 0));

it('follows the address; that of a worker started again is loaded, once all is saved', async () => {
  const reload = vi.spyOn(location, 'reload').mockImplementation(() => undefined);
  let saved = false;
  const mayReload = vi.fn(async () => {
    await turn();
    return saved;
  });
  const goTo = async (hash: string) => {
    location.hash = hash;
    await turn();
    await turn();
  };
  // A token that is still there at the start was there when the page was loaded: loading it again would not end.
  history.replaceState(null, '', '#token=left');
  const openLink = vi.fn();
  const isLink = (hash: string) => hash.startsWith('#/open');
  expect(startRouting({ mayReload, isLink, openLink })).toBe(false);
  await goTo('#/relief');
  expect(place.value).toBe('relief');
  expect(mayReload).not.toHaveBeenCalled();
  await goTo('#token=new');
  expect(mayReload).toHaveBeenCalledTimes(1);
  expect(reload).not.toHaveBeenCalled(); // it could not be saved
  saved = true;
  await goTo('#/relief&token=newer');
  expect(reload).toHaveBeenCalledTimes(1);
  // A link is opened once and leaves the address; one that comes with a token waits for the load.
  await goTo('#/open?v=1&relief=bust');
  expect(openLink.mock.calls).toEqual([['#/open?v=1&relief=bust']]);
  expect(location.hash).toBe('#/relief');
  await goTo('#/open?v=1&relief=bust&token=newest');
  expect(openLink).toHaveBeenCalledTimes(1);
  expect(reload).toHaveBeenCalledTimes(2);
});

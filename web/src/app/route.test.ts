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
  expect(startRouting(mayReload)).toBe(false);
  await goTo('#/relief');
  expect(place.value).toBe('relief');
  expect(mayReload).not.toHaveBeenCalled();
  await goTo('#token=new');
  expect(mayReload).toHaveBeenCalledTimes(1);
  expect(reload).not.toHaveBeenCalled(); // it could not be saved
  saved = true;
  await goTo('#/relief&token=newer');
  expect(reload).toHaveBeenCalledTimes(1);
});

// SPDX-License-Identifier: GPL-3.0-or-later
import type { Tutorial } from '../tutorial';
import { button, exactly, field, link, radio, stepsIn } from '../tutorial';

const rail = stepsIn(null);
const room = stepsIn('zippable');

export const zippable: Tutorial = {
  name: 'zippable',
  title: 'A star that zips up',
  makes: 'One flat ribbon of fabric with one zipper, and the sheets to cut it from.',
  steps: [
    rail.press('Choose **Zippable** in the bar of rooms.', exactly(link('Zippable')), [
      { shown: button('Open a model') },
    ]),
    room.press(
      'Choose the sample **Star**. Left you see where the zipper runs, right the ribbon laid flat.',
      button('Star'),
      [{ strip: 'Preview up to date' }],
      {
        picture: {
          name: 'zippable_preview',
          alt: 'The star with the line of its zipper, and its flat ribbon',
        },
      },
    ),
    room.enter(
      'Set **Windings** to 4 and press Enter. Fewer windings make a wider ribbon and a shorter zipper.',
      exactly(field('Windings')),
      '4',
      [{ strip: 'Preview up to date' }],
    ),
    room.press(
      'Press **Make the ribbon** and wait until **Ribbon unfolded** stands at the foot of the page.',
      button('Make the ribbon'),
      [{ strip: 'Ribbon unfolded' }],
    ),
    room.press('Choose **Zipped** to see the ribbon in its final shape.', radio('Zipped'), [
      { shown: button('Will it zip? Simulate cloth') },
    ]),
    room.press(
      'Press **Will it zip? Simulate cloth**. The sentence that appears says whether cloth takes this shape.',
      button('Will it zip? Simulate cloth'),
      [{ shown: radio('Simulated cloth') }],
      {
        picture: {
          name: 'zippable_cloth',
          alt: 'The zipped star as simulated cloth, with the verdict below it',
        },
      },
    ),
    room.press(
      'Choose **Sheets to cut**: the ribbon in pieces that fit the bed of a laser cutter.',
      radio('Sheets to cut'),
      [{ shown: button('Send to a machine') }],
    ),
    room.enter(
      'The sheets are as large as the bed of the laser that is chosen in Machines. For a smaller piece of cloth set **Sheet depth**, here 350 mm, and press Enter.',
      field('Sheet depth'),
      '350',
      [{ shown: button('Send to a machine') }],
      { picture: { name: 'zippable_sheets', alt: 'The pieces of the ribbon on sheets 400 mm wide' } },
    ),
    room.press(
      'Press **Export plan, SVG**. Red is cut, blue is marked, and the numbers say which edges meet.',
      button('Export plan, SVG'),
    ),
    room.look(
      'You are done. **Send to a machine** takes a sheet to the laser, in this page.',
      button('Send to a machine'),
    ),
  ],
};

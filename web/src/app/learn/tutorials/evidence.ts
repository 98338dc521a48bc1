// SPDX-License-Identifier: GPL-3.0-or-later
import type { Tutorial } from '../tutorial';
import { button, exactly, field, link, picture, stepsIn, toggle } from '../tutorial';

const rail = stepsIn(null);
const room = stepsIn('evidence');
const forming = stepsIn('thermoform');

export const evidence: Tutorial = {
  name: 'evidence',
  title: 'From a scan to a better print',
  makes: 'The cause of a misplaced colour, and prints that allow for it. Practised on a virtual object.',
  steps: [
    rail.press('Choose **Evidence** in the bar of rooms.', exactly(link('Evidence')), [
      { shown: button('Try a virtual object') },
    ]),
    room.press(
      'Press **Try a virtual object**: a formed and scanned pyramid whose fault you choose yourself.',
      button('Try a virtual object'),
      [{ shown: button('Make the virtual object') }],
    ),
    room.enter(
      'Set **Colder towards the right** to 0.4 and press Enter: a heater that is weak on one side.',
      field('Colder towards the right'),
      '0.4',
    ),
    room.press(
      'Press **Make the virtual object** and wait. The maps then show measured beside simulated.',
      button('Make the virtual object'),
      [{ strip: 'Compared with the settings as they are' }],
      {
        picture: {
          name: 'evidence_compared',
          alt: 'Maps of measured and simulated height, and of their difference',
        },
      },
    ),
    room.press(
      'Switch **Two causes at once** off. Looking for one cause only is much quicker.',
      toggle('Two causes at once'),
    ),
    room.press('Switch **Propose a measurement** off, too.', toggle('Propose a measurement')),
    room.enter(
      'Set **Triangles** to 500 and press Enter. This is coarse, but enough for a strong cause.',
      field('Triangles'),
      '500',
    ),
    room.press(
      'Press **Diagnose** and wait until **Diagnosis ready** stands at the foot of the page: one to three minutes.',
      exactly(button('Diagnose')),
      [{ strip: 'Diagnosis ready' }],
    ),
    room.press(
      'Press **Uneven heating, side to side**. It says how strong the cause is and what to do about it.',
      button('Uneven heating, side to side'),
      [],
      { picture: { name: 'evidence_cause', alt: 'The cause found, its strength and what to do' } },
    ),
    room.press(
      'Switch **Show the simulation with this cause included** on. The last map becomes paler: less is unexplained.',
      toggle('Show the simulation with this cause included'),
      [{ shown: picture('Distances between measured and simulated, with the cause') }],
      {
        picture: {
          name: 'evidence_gain',
          alt: 'The maps with the cause included, and how far the error falls',
        },
      },
    ),
    room.press(
      'Press **Use in the next print**. From now on this project forms sheets on this machine, fault included.',
      button('Use in the next print'),
      [{ shown: button('Used in the next print') }],
    ),
    rail.press('Choose **Thermoform** in the bar of rooms.', exactly(link('Thermoform')), [
      { shown: button('Open a model') },
    ]),
    forming.press(
      'Choose the sample **Pyramid**. Above its settings the panel names the machine it is formed on.',
      button('Pyramid'),
      [{ strip: 'Preview up to date' }, { shown: button('Form without the machine profile') }],
      { picture: { name: 'evidence_next_print', alt: 'The pyramid, formed on the diagnosed machine' } },
    ),
    forming.look(
      'You are done. Prints exported here put every colour where this machine needs it. The cross at its name goes back.',
      button('Form without the machine profile'),
    ),
  ],
};

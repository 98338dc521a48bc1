// SPDX-License-Identifier: GPL-3.0-or-later
import type { Tutorial } from '../tutorial';
import { button, exactly, link, list, radio, stepsIn } from '../tutorial';

const rail = stepsIn(null);
const room = stepsIn('machines');

export const laser: Tutorial = {
  name: 'laser',
  title: 'A first laser job',
  makes: 'A key tag, cut by a practice laser that exists on the screen only. A real one works the same.',
  steps: [
    rail.press('Choose **Machines** in the bar of rooms.', exactly(link('Machines')), [
      { shown: button('Try a sample drawing') },
    ]),
    room.press(
      'Press **Try a sample drawing**. It lies on the bed from above: black lines are cut, blue lines are marked.',
      button('Try a sample drawing'),
      [{ strip: 'Job ready' }],
      { picture: { name: 'laser_job', alt: 'The key tag on the bed of the laser' } },
    ),
    room.choose(
      'Choose **Card 0.5 mm** as **Preset**. It sets power, speed and the width of the cut, to begin with.',
      list('Preset'),
      'Card 0.5 mm',
      [{ strip: 'Job ready' }],
    ),
    room.press(
      'Press **Practise without a machine**. With a real laser you would press **Connect by cable**.',
      button('Practise without a machine'),
      [{ shown: exactly(button('Home')) }],
    ),
    room.press(
      'The machine does not know where its head is. Press **Home**.',
      button('Home'),
      [{ shown: button('Cancel') }],
      { picture: { name: 'laser_home', alt: 'The question before the head moves' } },
    ),
    room.press(
      'Nothing moves before you have confirmed it. Press **Home** in the question.',
      button('Home'),
      [{ enabled: exactly(button('Frame')) }],
    ),
    room.press(
      'Bring the head to the front left corner of your material. Press **Move right** once: one millimetre.',
      button('Move right'),
    ),
    room.press(
      'Press **Set origin here**. The job now begins at the place of the head.',
      button('Set origin here'),
    ),
    room.press(
      'Press **Frame**. The head will go once around the job, with the laser off.',
      exactly(button('Frame')),
      [{ shown: button('Cancel') }],
    ),
    room.press(
      'Confirm with **Frame**, and watch whether the job lies on the material.',
      exactly(button('Frame')),
      [{ gone: button('Cancel') }, { enabled: button('Start') }],
    ),
    room.press('Press **Start**.', button('Start'), [{ shown: button('Start with the laser on') }]),
    room.press(
      'Press **Start with the laser on**. **Stop** is always at hand; Esc pauses, Esc twice stops.',
      button('Start with the laser on'),
      [{ gone: button('Start with the laser on') }],
    ),
    room.wait(
      'Wait until **key tag is done** stands at the foot of the page, about ten seconds.',
      [{ strip: 'key tag is done' }],
      { picture: { name: 'laser_done', alt: 'The finished job, and the head back at its origin' } },
    ),
    room.press(
      'Choose **Console**. Under **1 job so far** stands when it began and how it ended.',
      radio('Console'),
    ),
  ],
};

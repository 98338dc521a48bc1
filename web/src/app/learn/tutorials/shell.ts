// SPDX-License-Identifier: GPL-3.0-or-later
import type { Tutorial } from '../tutorial';
import { button, exactly, field, item, link, picture, radio, stepsIn } from '../tutorial';

const rail = stepsIn(null);
const room = stepsIn('thermoform');

export const shell: Tutorial = {
  name: 'shell',
  title: 'A coloured plastic shell',
  makes: 'A vacuum-formed cat: the picture to print on the flat sheet, and the mould to form it over.',
  steps: [
    rail.press('Choose **Thermoform** in the bar of rooms.', exactly(link('Thermoform')), [
      { shown: button('Open a model') },
    ]),
    room.press(
      'Choose the sample **Cat**, which has colours of its own.',
      button('Cat'),
      [{ strip: 'Preview up to date' }],
      { picture: { name: 'shell_preview', alt: 'The cat under a formed sheet in its clamp frame' } },
    ),
    room.enter(
      'Set **Size** to 100 mm and press Enter. Tall models in a small frame stretch the sheet until it is thin.',
      exactly(field('Size')),
      '100',
      [{ strip: 'Preview up to date' }],
    ),
    room.press(
      'Press **Form at full detail** and wait until **Sheet formed** stands at the foot of the page.',
      button('Form at full detail'),
      [{ strip: 'Sheet formed' }],
    ),
    room.press(
      'Choose **Thickness**. The scale marks the thinnest place. Steep flanks as the cat’s are thin; a note says so below.',
      radio('Thickness'),
      [],
      {
        picture: { name: 'shell_thickness', alt: 'The formed sheet, dark where it is thin, with its scale' },
      },
    ),
    room.press(
      'Choose **Texture** and wait for the print at the right: the picture, distorted so that it fits after forming.',
      radio('Texture'),
      [{ shown: picture('The print, distorted') }],
      { picture: { name: 'shell_texture', alt: 'The coloured shell, and the distorted print beside it' } },
    ),
    room.press(
      'Choose **Undercut**. Dark walls lean over and hold the sheet: a stiff mould would not come out there.',
      radio('Undercut'),
      [{ shown: picture('Overhang') }],
      { picture: { name: 'shell_undercut', alt: 'The model, dark where its walls lean over' } },
    ),
    room.press(
      'Press **Export print**. Print the PDF at 100 %, and check its 100 mm ruler with a real one.',
      button('Export print'),
    ),
    room.press('Press the arrow beside it, **Export something else**.', button('Export something else'), [
      { shown: item('Mould, STL') },
    ]),
    room.press(
      'Choose **Mould, STL**: the negative of the cat, to print and to cast gypsum in.',
      item('Mould, STL'),
    ),
  ],
};

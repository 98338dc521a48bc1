// SPDX-License-Identifier: GPL-3.0-or-later
import type { Tutorial } from '../tutorial';
import { button, exactly, field, radio, stepsIn, view } from '../tutorial';

const start = stepsIn('start');
const room = stepsIn('relief');

export const relief: Tutorial = {
  name: 'relief',
  title: 'A relief of a head',
  makes: 'A relief 4 mm thick that looks like the whole head: a file to mill, print or cast.',
  steps: [
    start.press(
      'Choose the sample **Bust** on the start page. Your own model works the same: press **Open a file** instead.',
      button('Bust'),
      [{ strip: 'Preview up to date' }],
      { picture: { name: 'relief_preview', alt: 'The head on the left of a line, its relief on the right' } },
    ),
    room.keys(
      'Turn the head until you like the view: drag in the picture, or hold Shift and press an arrow key.',
      view('Model and relief'),
      ['Shift+ArrowRight', 'Shift+ArrowRight'],
      [{ enabled: button('Use this view') }],
    ),
    room.press(
      'Press **Use this view**. The relief is made anew, for what you see now.',
      button('Use this view'),
      [{ strip: 'Preview up to date' }],
      { picture: { name: 'relief_view', alt: 'The same head, turned, and the relief for this view' } },
    ),
    room.enter(
      'Set **Thickness** to 4 mm and press Enter. Thinner is quicker to carve; thicker also looks deep from the side.',
      field('Thickness'),
      '4',
      [{ strip: 'Preview up to date' }],
    ),
    room.press(
      'Choose **Shading difference** above the picture. Pale places are shaded like the model, dark places look flatter.',
      radio('Shading difference'),
      [],
      {
        picture: {
          name: 'relief_difference',
          alt: 'The relief, dark where its shading differs from the model',
        },
      },
    ),
    room.press(
      'Press **Solve at full detail**. The file is ready when **Relief ready** stands at the foot of the page.',
      button('Solve at full detail'),
      [{ strip: 'Relief ready' }],
    ),
    room.press(
      'Choose **Relief** above the picture and turn it by dragging, to see how thin it is.',
      exactly(radio('Relief')),
      [],
      { picture: { name: 'relief_ready', alt: 'The finished relief on its plate' } },
    ),
    room.press(
      'Press **Export STL**. The file is a closed solid with a flat back, in millimetres.',
      button('Export STL'),
    ),
    room.look(
      'You are done. The arrow beside **Export STL** has other formats; **Send to a machine** makes a milling job of it.',
      button('Send to a machine'),
    ),
  ],
};

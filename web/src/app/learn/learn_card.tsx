// SPDX-License-Identifier: GPL-3.0-or-later
// The card that says the next step of a tutorial, and the ring around the control that it is done with.
import { render } from 'preact';
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks';
import { Button, IconButton } from '../../ui';
import { crafts } from '../crafts';
import { Bold } from './bold';
import type { Spot } from './card_place';
import { placeCard } from './card_place';
import './learn.css';
import {
  isElsewhere,
  leaveTutorial,
  learning,
  looked,
  pointedAt,
  sayDone,
  skipStep,
  stepBack,
  stepNow,
} from './learning';
import type { Step } from './tutorial';

/** Looks, 50 ms apart, at which the card must still have the focus. */
const keptFor = 4;

function LearnCard() {
  const now = learning.value;
  const card = useRef<HTMLElement>(null);
  void looked.value;
  const target = pointedAt.value;
  const box = target?.isConnected ? target.getBoundingClientRect() : null;
  const [spot, setSpot] = useState<(Spot & { readonly of: string }) | null>(null);
  // At every look: the card may have been measured before it was shown, and a step has more text than the last.
  useLayoutEffect(() => {
    if (card.current === null) return;
    // Where it stood in another step or a window of another size says nothing of this one.
    const of = `${now?.step ?? 0} ${innerWidth} ${innerHeight}`;
    const next = placeCard(card.current, box, spot?.of === of ? spot : null);
    if (next.left !== spot?.left || next.top !== spot.top || spot.of !== of) setSpot({ ...next, of });
  });
  useEffect(() => {
    // The dialog that the tutorial was chosen in takes the focus back once more when it goes.
    let kept = 0;
    const focus = () => {
      if (card.current === null || kept === keptFor) return;
      const at = document.activeElement;
      if (at !== card.current && card.current.contains(at)) return; // somebody has gone on from the card
      kept = at === card.current ? kept + 1 : 0;
      if (kept === 0 && !document.querySelector('dialog[open]')) card.current.focus();
      timer = setTimeout(focus, 50);
    };
    let timer = setTimeout(focus, 0);
    return () => clearTimeout(timer);
  }, [now?.tutorial]);
  if (now === null) return null;
  const { tutorial, step } = now;
  const current = stepNow();
  return (
    <>
      {target && box ? <Ring box={partInSight(target, box)} /> : null}
      <aside
        ref={card}
        class="learn-card"
        tabIndex={-1}
        aria-label={`Tutorial: ${tutorial.title}`}
        style={spot ? { left: `${spot.left}px`, top: `${spot.top}px` } : { visibility: 'hidden' }}
      >
        <header>
          <strong class="grow">{tutorial.title}</strong>
          <IconButton icon="close" label="Leave the tutorial" onClick={leaveTutorial} />
        </header>
        <div aria-live="polite">
          <p class="learn-count">
            {current ? `Step ${step + 1} of ${tutorial.steps.length}` : 'All steps done'}
          </p>
          <p>{current ? <StepText step={current} /> : 'What you made is kept in this project.'}</p>
        </div>
        {current ? (
          <Buttons step={current} first={step === 0} />
        ) : (
          <Button onClick={leaveTutorial}>Close</Button>
        )}
      </aside>
    </>
  );
}

function StepText({ step }: { step: Step }) {
  if (isElsewhere(step)) {
    const room = crafts.find((craft) => craft.place === step.room)?.title;
    return room ? (
      <>
        This step is in another room. Choose <strong>{room}</strong> in the bar of rooms.
      </>
    ) : (
      <>This step is on the start page. Press the sign at the top left.</>
    );
  }
  return <Bold text={step.text} />;
}

function Buttons({ step, first }: { step: Step; first: boolean }) {
  const target = pointedAt.value;
  const looking = step.done.some((sign) => 'said' in sign);
  const show = () => {
    target?.scrollIntoView({ block: 'center', behavior: 'instant' });
    target?.focus();
  };
  return (
    <div class="learn-buttons">
      {first ? null : (
        <Button size="small" kind="quiet" onClick={stepBack}>
          Back
        </Button>
      )}
      <span class="grow" />
      {target ? (
        <Button size="small" title="Scrolls to the control and moves the keyboard there" onClick={show}>
          Show me where
        </Button>
      ) : null}
      {looking && !isElsewhere(step) ? (
        <Button size="small" kind="filled" onClick={sayDone}>
          Next
        </Button>
      ) : (
        <Button size="small" kind="quiet" onClick={skipStep}>
          Skip this step
        </Button>
      )}
    </div>
  );
}

const margin_px = 5;
const min_seen_px = 12;

/** What of a control is in sight: not scrolled away, nor under the bar of rooms; null where that is next to nothing. */
function partInSight(control: Element, box: DOMRect): DOMRect | null {
  let { left, top, right, bottom } = box;
  for (let parent = control.parentElement; parent !== null; parent = parent.parentElement) {
    if (!/auto|scroll/.test(getComputedStyle(parent).overflowY)) continue;
    const seen = parent.getBoundingClientRect();
    left = Math.max(left, seen.left);
    top = Math.max(top, seen.top);
    right = Math.min(right, seen.right);
    bottom = Math.min(bottom, seen.bottom);
  }
  const bar = document.querySelector('nav');
  // At the left on a desk, below on a phone.
  if (bar !== null && !bar.contains(control)) {
    const { top: barTop, left: barLeft } = bar.getBoundingClientRect();
    if (barLeft <= left && barTop > innerHeight / 2) bottom = Math.min(bottom, barTop);
  }
  const [width, height] = [right - left, bottom - top];
  return Math.min(width, height) < min_seen_px ? null : new DOMRect(left, top, width, height);
}

function Ring({ box }: { box: DOMRect | null }) {
  if (box === null) return null;
  return (
    <div
      class="learn-ring"
      aria-hidden="true"
      style={{
        left: `${box.left - margin_px}px`,
        top: `${box.top - margin_px}px`,
        width: `${box.width + 2 * margin_px}px`,
        height: `${box.height + 2 * margin_px}px`,
      }}
    />
  );
}

/** Draws the card over everything. A question makes the rest of the page inert, so the card moves into it meanwhile. */
export function showLearnCard(): () => void {
  const host = document.createElement('div');
  host.className = 'learn';
  const follow = () => {
    const dialogs = document.querySelectorAll('dialog[open]');
    const home = dialogs[dialogs.length - 1] ?? document.body;
    if (host.parentElement !== home) home.append(host);
  };
  follow();
  const changes = new MutationObserver(follow);
  changes.observe(document.body, { childList: true, subtree: true, attributeFilter: ['open'] });
  render(<LearnCard />, host);
  return () => {
    changes.disconnect();
    render(null, host);
    host.remove();
  };
}

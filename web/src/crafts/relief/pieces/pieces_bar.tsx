// SPDX-License-Identifier: GPL-3.0-or-later
// How far the pieces are pulled apart, and what they come to.
import { useId } from 'preact/hooks';
import { formatFixed, Icon, withUnit } from '../../../ui';
import { figure } from '../../../shared/session/report';
import type { ReliefPieces } from './relief_pieces';
import './pieces_bar.css';

const steps = 20;

export function PiecesBar({ pieces }: { readonly pieces: ReliefPieces }) {
  const id = useId();
  const made = pieces.made.value;
  return (
    <section class="panel pieces-bar" aria-label="Pieces">
      <p aria-live="polite">
        {pieces.problem.value ? (
          <span class="problem">{pieces.problem.value}</span>
        ) : made === null || pieces.running.value ? (
          <>
            <Icon name="clock" small /> Making the pieces
          </>
        ) : (
          `${made.pieces.length} pieces, ${withUnit(formatFixed(figure(made.report, 'pieces_volume_ml') ?? 0, 1), 'ml')}`
        )}
      </p>
      <label for={id}>Pulled apart</label>
      <input
        id={id}
        type="range"
        min={0}
        max={steps}
        value={Math.round(steps * pieces.apart.value)}
        aria-valuetext={withUnit(String(Math.round(100 * pieces.apart.value)), '%')}
        style={{ '--filled': `${100 * pieces.apart.value}%` }}
        onInput={({ currentTarget }) => (pieces.apart.value = Number(currentTarget.value) / steps)}
      />
    </section>
  );
}

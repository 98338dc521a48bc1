// SPDX-License-Identifier: GPL-3.0-or-later
// What a calibration fitted, how well the data tell each parameter, and how much closer the simulation came.
import type { JsonObject } from '../../jobs/contract';
import { isObject } from '../../project/document';
import { formatNumber, withUnit } from '../../ui';
import type { CraftResult } from '../../shared/session/craft_document';
import { figure, sentences } from '../../shared/session/report';
import { useEffect, useState } from 'preact/hooks';
import type { EvidenceSession } from './evidence_session';
import { shortNumber } from './inspector';
import { Pane } from './pictures/maps';

interface Profile {
  readonly name: string;
  readonly label: string;
  readonly unit: string;
  readonly value: number;
  readonly low: number;
  readonly high: number;
  readonly identified: boolean;
  /** Value and log likelihood. */
  readonly points: readonly (readonly [number, number])[];
}

const number = (value: unknown): number =>
  typeof value === 'number' && Number.isFinite(value) ? value : NaN;

/** Of calibration.json; a grid search has values without intervals. */
function readProfiles(calibration: JsonObject): Profile[] {
  const profiles = Array.isArray(calibration['profiles']) ? calibration['profiles'].filter(isObject) : [];
  const plain = Array.isArray(calibration['parameters']) ? calibration['parameters'].filter(isObject) : [];
  return (profiles.length > 0 ? profiles : plain).map((one) => ({
    name: String(one['name']),
    label: String(one['label']),
    unit: String(one['unit'] ?? ''),
    value: number(one['value']),
    low: number(one['low']),
    high: number(one['high']),
    identified: one['identified'] !== false,
    points: (Array.isArray(one['profile']) ? one['profile'].filter(isObject) : [])
      .map((point) => [number(point['value']), number(point['log_likelihood'])] as const)
      .filter(([value, likelihood]) => !Number.isNaN(value) && !Number.isNaN(likelihood))
      .sort(([a], [b]) => a - b),
  }));
}

export function CalibrationPanel({ session, result }: { session: EvidenceSession; result: CraftResult }) {
  const [profiles, setProfiles] = useState<readonly Profile[]>([]);
  const reference = result.outputs['calibration.json'];
  useEffect(() => {
    setProfiles([]);
    if (reference)
      session.services.projects.blobs.read(reference.blob).then(
        (bytes) => {
          const read = JSON.parse(new TextDecoder().decode(bytes)) as unknown;
          if (isObject(read)) setProfiles(readProfiles(read));
        },
        () => undefined,
      );
  }, [reference?.blob]);
  const length = (name: string) => {
    const value = figure(result.report, name);
    return value === null ? '–' : withUnit(formatNumber(value, 2), 'mm');
  };
  const notes = sentences(result.report, 'notes');
  return (
    <Pane
      title="Calibrated material"
      detail={`mean distance ${length('error_nominal_mm')} to ${length('error_mean_mm')}; noise ${length('noise_mm')}`}
    >
      <table class="calibration">
        <thead>
          <tr>
            <th scope="col">Parameter</th>
            <th scope="col">Fitted</th>
            <th scope="col">95 % interval</th>
            <th scope="col">Likelihood</th>
          </tr>
        </thead>
        <tbody>
          {profiles.map((profile) => (
            <tr key={profile.name}>
              <th scope="row">
                {profile.label}
                {profile.unit ? <small>, {profile.unit}</small> : null}
              </th>
              <td>{shortNumber(profile.value)}</td>
              <td>
                {profile.identified && profile.high > profile.low ? (
                  `${shortNumber(profile.low)} to ${shortNumber(profile.high)}`
                ) : profile.identified ? (
                  '–'
                ) : (
                  <em>this measurement does not tell</em>
                )}
              </td>
              <td>
                <Likelihood profile={profile} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      {notes.length > 0 ? (
        <ul class="plain-list">
          {notes.map((note) => (
            <li key={note}>{note}</li>
          ))}
        </ul>
      ) : null}
    </Pane>
  );
}

/** How much the best fit with each value falls behind; further than this is off the chart. */
const shownFall = 8;
const [width, height] = [120, 30];

function Likelihood({ profile: { label, points, value, identified } }: { profile: Profile }) {
  const [first, last] = [points[0], points.at(-1)];
  if (!first || !last || first[0] === last[0]) return null;
  const best = Math.max(...points.map(([, likelihood]) => likelihood));
  const x = (at: number) => 2 + ((at - first[0]) / (last[0] - first[0])) * (width - 4);
  const y = (likelihood: number) => 3 + (Math.min(best - likelihood, shownFall) / shownFall) * (height - 6);
  const line = points.map(([at, likelihood]) => `${x(at).toFixed(1)} ${y(likelihood).toFixed(1)}`).join('L');
  const words = identified ? 'falls on both sides of the fitted value' : 'hardly falls over the whole range';
  return (
    <svg
      class="likelihood"
      viewBox={`0 0 ${width} ${height}`}
      role="img"
      aria-label={`Likelihood of ${label} from ${shortNumber(first[0])} to ${shortNumber(last[0])}: ${words}.`}
    >
      <line x1={x(value)} x2={x(value)} y1="1" y2={height - 1} />
      <path d={`M${line}`} />
    </svg>
  );
}

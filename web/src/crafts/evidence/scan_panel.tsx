// SPDX-License-Identifier: GPL-3.0-or-later
import { Button } from '../../ui';
import type { Scan } from './evidence_document';
import type { EvidenceSession } from './evidence_session';

export interface ScanPanelProps {
  readonly session: EvidenceSession;
  readonly scan: Scan;
  readonly onChooseFile: () => void;
}

export function ScanPanel({ onChooseFile }: ScanPanelProps) {
  return <Button onClick={onChooseFile}>Choose</Button>;
}

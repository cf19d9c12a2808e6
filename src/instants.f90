!> The instants of a set: solved one after another, and written as the command and the deck ask.
module instants
   use mechanism, only: mechanism_t, instant_count, instant
   use structure, only: findings_t
   use text_output, only: output_t
   use progress, only: progress_t, show_progress
   use listing, only: layout_t, listing_instant, listing_end, listing_broken_off
   use csv, only: csv_instant
   use table, only: table_t, table_instant
   use drawing, only: drawing_t
   use solver_log, only: log_instant
   use convergence, only: convergence_t
   use branch_certificate, only: branch_t
   use points, only: strides, any_due
   use deck_variants, only: variation_t
   use answers, only: answers_t, new_answers, take_instant, put_answers
   use variant_rows, only: variant_row_t, note_flag
   use numerals, only: whole
   use motion_proof, only: holds
   use set_motion, only: has_words
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, sample_set, sense_set, prove_set, &
      set_record, set_errors, set_closure_error, set_closing_diagnostics
   use command_line, only: options_t, out_listing, out_csv, out_log, out_table, out_plot_table
   use outputs, only: outputs_t, is_over
   implicit none
   private
   public :: writers_t, run_motion

   !> The job's outputs, and what they keep from instant to instant.
   type, extends(outputs_t) :: writers_t
      type(progress_t) :: progress
      integer :: first = 1, last = 0                !< the sets that were read
      !> Those that this process computes; where the deck has VARY cards, numbers of variants, counted through all sets.
      integer :: own_first = 1, own_last = 0
      type(layout_t) :: layout                      !< of the listing of the set at hand
      type(table_t) :: table                        !< of the set at hand
      logical :: varies = .false.                   !< the deck has VARY cards
      type(variation_t), allocatable :: variations(:)   !< of the sets that have them
      type(drawing_t), allocatable :: drawings(:), films(:)   !< (first:last)
   end type writers_t

contains

   !> Solves and writes set number `i`, `m`, instant by instant; `full`: its tables too. `row`: how many instants are
   !> solved and flagged, and the first of those; `asked`: the answers to its cards.
   subroutine run_motion(options, m, i, findings, full, o, row, asked)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      type(findings_t), intent(inout) :: findings
      logical, intent(in) :: full
      type(writers_t), intent(inout) :: o
      type(variant_row_t), intent(inout) :: row
      type(answers_t), intent(out) :: asked
      type(set_analysis_t) :: a
      integer, allocatable :: every(:)
      logical :: lists
      integer :: k

      call make_set_analysis(m, a, findings)
      if (o%asked(out_listing) .or. m%variants > 0) call new_answers(m, a, asked)
      lists = full .and. o%asked(out_listing)
      every = strides(m)
      do k = 0, instant_count(m) - 1
         call advance_set(a, instant(m, k))
         if (m%proves) then
            call prove_set(a)
            if (.not. all(holds(a%now%proofs))) row%unproved = row%unproved + 1
         end if
         call note_flag(row, a)
         call write_instant(any_due(m, every, k))
         call take_instant(asked, m, a, k, any_due(m, every, k))
         if (o%progress%shown .and. m%variants == 0) &
            call show_progress(o%progress, 'SET '//whole(i)//': INSTANT', k, instant_count(m) - 1)
         if (.not. is_over(o, i)) cycle
         if (lists .and. m%variants == 0) call listing_broken_off(o%files(out_listing, 0), m, k)
         return
      end do
      if (lists) call put_answers(o%files(out_listing, 0), o%layout, asked, m, a)
      if (lists) call listing_end(o%files(out_listing, 0), m, row%solved, row%flagged, &
         a%certificate_counts, set_closure_error(a), set_closing_diagnostics(a, m))

   contains

      !> Writes instant number `k` of set number `i`, `m`, to which `a` has advanced; `due`: PRINT asks for it; `lists`:
      !> what there is of it stands in the listing. Only that, and estimates that are asked for, need samples.
      subroutine write_instant(due)
         logical, intent(in) :: due

         if (options%errors .or. (due .and. lists)) call sample_set(a, options%errors)
         if (due .and. (lists .or. any(o%asked([out_csv, out_table, out_plot_table])))) call sense_set(a)
         if (lists .and. (due .or. has_words(a%now))) &
            call listing_instant(o%files(out_listing, 0), o%layout, m, a%now, k)
         if (o%asked(out_csv) .and. due) call csv_instant(o%files(out_csv, 0), m, a%now, k, o%varies, a%assemblies)
         if (o%asked(out_table) .and. due) call table_instant(o%files(out_table, i), o%table, m, a%now)
         if (o%asked(out_plot_table) .and. due) call table_instant(o%files(out_plot_table, i), o%table, m, a%now)
         if (o%asked(out_log)) call put_log(o%files(out_log, 0))
      end subroutine write_instant

      !> The line of instant number `k` in the log.
      subroutine put_log(log)
         type(output_t), intent(inout) :: log
         type(convergence_t) :: record
         type(branch_t) :: branch

         call set_record(a, record, branch)
         if (options%errors) then
            call log_instant(log, k, instant(m, k), record, branch, set_errors(a))
         else
            call log_instant(log, k, instant(m, k), record, branch)
         end if
      end subroutine put_log
   end subroutine run_motion
end module instants

!> The printed listing, in the form of the paper's Rys. 5: title, data, structure, then the tables.
!> It takes finished data and depends on nothing else: two correct programs print the same bytes.
module listing
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, mark_none, mark_not_converged, mark_singular, mark_overflow, &
      mark_inconsistent
   use structure, only: findings_t
   use branch_certificate, only: certificate_counts_t
   use diagnostics, only: diagnostic_t
   use listing_structure, only: put_structure
   use listing_diagnostics, only: put_diagnostics, put_closure_error
   use points, only: is_due
   use set_motion, only: set_motion_t, is_flagged, in_set
   use listing_tables, only: table_t, put_requested, put_units
   use text_output, only: output_t, put
   use numerals, only: fixed, whole, numeral_length
   use known_digits, only: unknown_digit
   use error_estimate, only: error_estimate_t
   use layout, only: layout_t, new_layout
   use phrases, only: phrase, say_program, say_set, say_title, say_data, say_results, &
      say_end, say_solved, say_flagged, say_no_position, say_no_rates, say_overflow, say_contradiction, &
      say_unknown, say_branch, say_followed, say_passed, say_uncertain, say_broken_off
   implicit none
   private
   public :: layout_t, new_layout, listing_head, listing_instant, listing_set_instant, listing_end, listing_broken_off

contains

   !> Title, data and structure of one set.
   subroutine listing_head(o, l, m, findings)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: findings
      integer :: i

      associate (pl => m%polish)
         call put(o, ' KINMAT   '//phrase(say_program, pl))
         call put(o, '')
         call put(o, trim(' '//phrase(say_set, pl)//' '//whole(m%set_number) &
            //'   '//phrase(say_title, pl)//'   '//m%title))
         call put(o, '')
         call put(o, ' '//phrase(say_data, pl))
         do i = 1, size(m%echo)
            call put(o, ' '//trim(m%echo(i)))
         end do
         call put(o, '')
         call put_structure(o, m, findings)
         call put(o, '')
         call put(o, ' '//phrase(say_results, pl))
         call put_units(o, l, m)
      end associate
   end subroutine listing_head

   !> The tables of instant number `step` (0, 1, ...) of the motion `q` of all of `m`, as far as the deck asks for them
   !> there; digits that `kantorovich_ratio` leaves open are masked.
   subroutine listing_instant(o, l, m, q, step, kantorovich_ratio)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: step
      type(error_estimate_t), intent(in), optional :: kantorovich_ratio
      type(table_t) :: table
      integer :: i

      do i = 1, size(m%requests)
         if (.not. is_due(m, m%requests(i), step)) cycle
         if (table%kind == 0) call put_instant(o, l, q%t, step)
         call put_requested(o, l, i, m, q, m%requests(i), table, kantorovich_ratio)
      end do
      if (table%kind == 0 .and. q%mark /= mark_none) call put_instant(o, l, q%t, step)
      if (q%mark /= mark_none) call put(o, ' *** '//mark_text(q%mark, m%polish))
      call put_masked(o, m, table)
      if (allocated(q%diagnostics)) call put_diagnostics(o, m, q%diagnostics)
   end subroutine listing_instant

   !> The same of the motions `s` of the independent mechanisms of `m`.
   subroutine listing_set_instant(o, l, m, s, step)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: step
      type(table_t) :: table
      integer :: i, c, k

      if (size(s%own) == 0) then
         call listing_instant(o, l, m, s%motions(1), step, s%kantorovich_ratios(1))
         return
      end if
      do i = 1, size(m%requests)
         if (.not. is_due(m, m%requests(i), step)) cycle
         if (table%kind == 0) call put_instant(o, l, s%motions(1)%t, step)
         c = s%parts%part(i)
         if (c == 0) then
            call put_requested(o, l, i, m, s%motions(1), m%requests(i), table)
         else
            call put_requested(o, l, i, s%own(c), s%motions(c), s%own(c)%requests(s%parts%number(i)), table, &
               s%kantorovich_ratios(c))
         end if
      end do
      if (table%kind == 0 .and. is_flagged(s)) call put_instant(o, l, s%motions(1)%t, step)
      do k = mark_none + 1, mark_inconsistent
         if (any(s%motions%mark == k)) call put(o, ' *** '//mark_text(k, m%polish))
      end do
      call put_masked(o, m, table)
      do c = 1, size(s%motions)
         if (.not. allocated(s%motions(c)%diagnostics)) cycle
         call put_diagnostics(o, m, [(in_set(s%motions(c)%diagnostics(k), s%parts%list(c)), k=1, &
            size(s%motions(c)%diagnostics))])
      end do
   end subroutine listing_set_instant

   !> What a question mark stands for, where there is one.
   subroutine put_masked(o, m, table)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(table_t), intent(in) :: table

      if (table%masked) call put(o, ' --- '//unknown_digit//': '//phrase(say_unknown, m%polish))
   end subroutine put_masked

   subroutine put_instant(o, l, t, step)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      real(wp), intent(in) :: t
      integer, intent(in) :: step
      character(numeral_length) :: time

      time = adjustl(fixed(t, l%time_decimals, l%time_power))
      call put(o, '')
      call put(o, l%instant//whole(step)//'   T = '//trim(time))
   end subroutine put_instant

   pure function mark_text(mark, pl) result(text)
      integer, intent(in) :: mark
      logical, intent(in) :: pl
      character(:), allocatable :: text

      select case (mark)
      case (mark_not_converged)
         text = phrase(say_no_position, pl)
      case (mark_singular)
         text = phrase(say_no_rates, pl)
      case (mark_overflow)
         text = phrase(say_overflow, pl)
      case (mark_inconsistent)
         text = phrase(say_contradiction, pl)
      case default
         text = ''
      end select
   end function mark_text

   !> The last lines of a set: what is known of the branches on which its instants were found, then how many were solved
   !> and how many are marked; before them, where equations are redundant, by how much they differ (`closure_error`, in
   !> parts
   !> of the characteristic length; negative where none are); and other `diagnostics`.
   subroutine listing_end(o, m, solved, flagged, certificate_counts, closure_error, diagnostics)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: solved, flagged
      type(certificate_counts_t), intent(in) :: certificate_counts
      real(wp), intent(in), optional :: closure_error
      type(diagnostic_t), intent(in), optional :: diagnostics(:)

      call put(o, '')
      if (present(closure_error)) then
         if (closure_error >= 0.0_wp) call put_closure_error(o, m, closure_error)
      end if
      if (present(diagnostics)) call put_diagnostics(o, m, diagnostics)
      call put(o, ' '//phrase(say_branch, m%polish)//':  '//phrase(say_followed, &
         m%polish)//' '//whole(certificate_counts%followed) &
         //', '//phrase(say_passed, m%polish)//' '//whole(certificate_counts%passed) &
         //', '//phrase(say_uncertain, m%polish)//' '//whole(certificate_counts%uncertain))
      call put(o, ' '//phrase(say_end, m%polish)//' '//whole(m%set_number) &
         //':  '//phrase(say_solved, m%polish)//' '//whole(solved) &
         //', '//phrase(say_flagged, m%polish)//' '//whole(flagged))
      call put(o, '')
   end subroutine listing_end

   !> The line in the place of what follows instant number `step`, where a run ends before its time.
   subroutine listing_broken_off(o, m, step)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: step

      call put(o, '')
      call put(o, ' *** '//phrase(say_broken_off, m%polish)//' '//whole(step))
   end subroutine listing_broken_off
end module listing

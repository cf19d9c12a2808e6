!> What card PROVE has proved: a line for each printed instant, with what led to it since the one before; why instants
!> are not proved; and the counts.
module proof_table
   use kinds, only: wp
   use mechanism, only: settings_t, instant
   use motion, only: mark_none
   use following, only: branch_crossed
   use motion_proof, only: holds
   use names, only: listed
   use set_analysis, only: set_analysis_t, set_bounds
   use listing, only: words_of_mark
   use listing_layout, only: layout_t, put_folded
   use table, only: right
   use listing_tables, only: time_text
   use text_output, only: output_t, put
   use numerals, only: whole
   use phrases
   implicit none
   private
   public :: proof_table_t, note_proof, put_proofs

   !> Of a printed instant, and the steps to it from the last one.
   type :: line_t
      integer :: step = 0                        !< number of the instant
      logical :: is_proved = .true.
      integer :: parts = 0                       !< into which the steps were divided
      real(wp) :: tube = 0.0_wp                  !< largest radius, in rad and units of the blocks
      real(wp) :: bounds(0:2) = 0.0_wp           !< of errors, in the characteristic length and rate
   end type line_t

   !> Why an instant is not proved.
   type :: reason_t
      integer :: step = 0
      character(:), allocatable :: words
   end type reason_t

   type :: proof_table_t
      type(line_t), allocatable :: lines(:)      !< with room behind
      integer :: count = 0                       !< of them; the next one is in the making
      type(reason_t), allocatable :: reasons(:)  !< the first ones
      integer :: instants = 0, proved = 0        !< in all
      real(wp) :: gap = 0.0_wp                   !< of redundant equations at most, in units of the blocks
   end type proof_table_t

   !> So many reasons are written; of more, the number.
   integer, parameter :: max_reasons = 50
   integer, parameter :: number_width = 12

contains

   !> Takes what is proved of instant number `k`, to which `s` has advanced; `due`: it is printed.
   subroutine note_proof(p, s, k, due)
      type(proof_table_t), intent(inout) :: p
      type(set_analysis_t), intent(in) :: s
      integer, intent(in) :: k
      logical, intent(in) :: due
      type(reason_t) :: reason
      integer :: c

      if (.not. allocated(p%lines)) allocate (p%lines(max(2, s%now%steps + size(s%now%at) + 2)), p%reasons(0))
      p%instants = p%instants + 1
      associate (line => p%lines(p%count + 1))
         do c = 1, s%now%count
            associate (proof => s%now%proofs(c))
               line%parts = line%parts + proof%step%parts
               line%tube = max(line%tube, proof%step%radius)
               if (proof%is_proved) p%gap = max(p%gap, proof%gap)
               if (holds(proof)) cycle
               line%is_proved = .false.
               if (size(p%reasons) == max_reasons) cycle
               associate (q => s%now%motions(c), m => s%now%parts(c))
                  reason = reason_t(k, '')
                  if (q%mark /= mark_none) then
                     reason%words = words_of_mark(q%mark, q%singularity, m%polish)
                  else if (s%list(c)%branch%kind == branch_crossed) then
                     reason%words = phrase(say_change_inside, m%polish)
                  else
                     reason%words = phrase(say_near_singular, m%polish)
                     if (proof%too_many > 0) &
                        reason%words = phrase(say_too_wide, m%polish)//' '//whole(proof%too_many)
                     if (allocated(proof%failed)) then
                        if (size(proof%failed) > 0) reason%words = phrase(say_links, m%polish)//' ' &
                           //listed(m%links(proof%failed)%name, m%polish)//': '//reason%words
                     end if
                  end if
               end associate
               p%reasons = [p%reasons, reason]
            end associate
         end do
         if (all(holds(s%now%proofs))) p%proved = p%proved + 1
         if (.not. due) return
         line%step = k
         line%bounds = set_bounds(s)
         p%count = p%count + 1
      end associate
   end subroutine note_proof

   !> Writes all of it after the last instant of `m`; `l`: the layout of its tables.
   subroutine put_proofs(o, l, p, m)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(proof_table_t), intent(in) :: p
      class(settings_t), intent(in) :: m
      character(:), allocatable :: start, gap
      integer :: i

      call put(o, '')
      call put(o, ' '//phrase(say_proof, m%polish))
      call put(o, column(phrase(say_instant, m%polish))//column('T')//column(phrase(say_parts, m%polish)) &
         //column(phrase(say_tube, m%polish))//column(phrase(say_position, m%polish)) &
         //column(phrase(say_velocity, m%polish))//'  '//column(phrase(say_acceleration, m%polish)))
      do i = 1, p%count
         associate (line => p%lines(i))
            start = column(whole(line%step))//column(time_text(l, instant(m, line%step)))
            if (line%is_proved) then
               call put(o, start//column(whole(line%parts))//column(rounded_up(line%tube)) &
                  //column(rounded_up(line%bounds(0)))//column(rounded_up(line%bounds(1))) &
                  //'  '//column(rounded_up(line%bounds(2))))
            else
               call put(o, start//'   '//phrase(say_not_proved, m%polish))
            end if
         end associate
      end do
      do i = 1, size(p%reasons)
         associate (r => p%reasons(i))
            call put_folded(o, ' *** ', phrase(say_instant, m%polish)//' '//whole(r%step)//', T = ' &
               //time_text(l, instant(m, r%step))//': '//phrase(say_not_proved, m%polish)//': '//r%words)
         end associate
      end do
      if (p%instants - p%proved > size(p%reasons)) call put(o, ' *** '//phrase(say_not_proved, m%polish) &
         //': '//whole(p%instants - p%proved))
      gap = ''
      if (p%gap > 0.0_wp) gap = ',  '//phrase(say_closure_error_of, m%polish)//' '//rounded_up(p%gap)
      call put(o, ' '//phrase(say_proved, m%polish)//' '//whole(p%proved)//' / '//whole(p%instants) &
         //',  '//phrase(say_parts, m%polish)//' '//whole(sum(p%lines(:p%count)%parts)) &
         //',  '//phrase(say_tube, m%polish)//' '//rounded_up(maxval([0.0_wp, p%lines(:p%count)%tube]))//gap)
   end subroutine put_proofs

   !> `text` at the right of a column.
   pure function column(text)
      character(*), intent(in) :: text
      character(number_width) :: column

      column = right(text, number_width)
   end function column

   !> `x` with one digit, rounded up; 0 is exact.
   pure function rounded_up(x) result(text)
      real(wp), intent(in) :: x
      character(:), allocatable :: text
      character(8) :: field
      real(wp) :: large
      integer :: first, power, digit

      text = '0'
      if (.not. x > 0.0_wp) return
      ! Numbers next to the end of the range are none.
      large = min(max(x, tiny(x)/epsilon(x)**2), huge(x)*epsilon(x)**2)
      ! Of the power of two: its own or one less.
      first = floor((exponent(large) - 1)*log10(2.0_wp))
      do power = first, first + 1
         digit = max(1, ceiling(large/10.0_wp**power))
         if (digit <= 9) exit
      end do
      write (field, '(i0, a, sp, i0.2)') digit, '.E', max(-999, min(power, 999))
      text = trim(field)
   end function rounded_up
end module proof_table
